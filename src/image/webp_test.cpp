#include "image/webp.h"

#include <gtest/gtest.h>

#include "core/hash.h"
#include "image/testing/webp.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

using testing::make_webp;

std::vector<uint8_t> gradient(int width, int height) {
  std::vector<uint8_t> rgba;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int value : {8 * x, 255 - 8 * y, 5 * (x + y), 255 - 4 * x})
        rgba.push_back(static_cast<uint8_t>(value));
    }
  }
  return rgba;
}

std::string sentence_of(const std::vector<std::byte>& bytes) {
  try {
    detail::decode_webp(bytes, "wood.webp");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Webp, LosslessImagesAreKeptAsStored) {
  const std::vector<uint8_t> rgba = gradient(30, 20);
  const std::vector<std::byte> bytes = make_webp(30, 20, rgba);
  EXPECT_TRUE(detail::is_webp(bytes));
  const detail::DecodedPixels pixels = detail::decode_webp(bytes, "t");
  EXPECT_EQ(pixels.width, 30);
  EXPECT_EQ(pixels.height, 20);
  for (size_t i = 0; i < rgba.size(); ++i) {
    const bool is_visible = rgba[i / 4 * 4 + 3] != 0;  // colours of transparent pixels need not be preserved
    ASSERT_TRUE(!is_visible || pixels.rgba8[i] == rgba[i]) << i;
  }
}

TEST(Webp, LossyImagesAreClose) {
  std::vector<uint8_t> rgba = gradient(30, 20);
  for (size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 255;
  const detail::DecodedPixels pixels = detail::decode_webp(make_webp(30, 20, rgba, 90), "t");
  double sum = 0;
  for (size_t i = 0; i < rgba.size(); ++i) sum += std::abs(pixels.rgba8[i] - rgba[i]);
  EXPECT_LT(sum / static_cast<double>(rgba.size()), 6);
  EXPECT_GT(sum, 0) << "it is not lossy";
}

TEST(Webp, ImagesOfOneColourAreSmallFiles) {
  const std::vector<uint8_t> white(size_t{4} * 1024 * 1024, 255);
  const std::vector<std::byte> bytes = make_webp(1024, 1024, white);
  EXPECT_LT(bytes.size(), 100u);
  EXPECT_EQ(detail::decode_webp(bytes, "t").rgba8, white);
}

TEST(Webp, AnyImageReaderTakesThem) {
  const std::vector<uint8_t> rgba{255, 0, 255, 255, 0, 255, 0, 255};
  const Image image = parse_image(make_webp(2, 1, rgba), "t");
  EXPECT_EQ(image.at(0, 0), Rgb(1, 0, 1));
  EXPECT_EQ(image.at(1, 0), Rgb(0, 1, 0));
}

TEST(WebpMalformed, SmallFilesCannotHoldHugeImages) {
  for (const int size : {4096, 4097}) {
    const std::vector<std::byte> bytes = testing::webp_header(size, size);
    EXPECT_EQ(detail::webp_size(bytes, "t").width, size);
    const bool is_refused = sentence_of(bytes).find("more than a file of 30 bytes can hold") != std::string::npos;
    EXPECT_EQ(is_refused, size > 4096) << sentence_of(bytes);
  }
}

TEST(WebpMalformed, CutOffFilesAreOneSentence) {
  const std::vector<uint8_t> rgba = gradient(30, 20);
  for (const std::vector<std::byte>& whole : {make_webp(30, 20, rgba), make_webp(30, 20, rgba, 90)}) {
    for (size_t size = 12; size + 2 < whole.size(); size += 1 + whole.size() / 60) {
      const std::string sentence = sentence_of({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
      EXPECT_EQ(sentence.find("wood.webp: damaged WebP image ("), 0u) << size << ": " << sentence;
    }
  }
}

TEST(WebpMalformed, UnknownVersionsAreInconsistentData) {
  std::vector<std::byte> bytes = make_webp(30, 20, gradient(30, 20));
  constexpr size_t kVersion = 24;  // in its upper three bits, after the sizes
  bytes[kVersion] |= std::byte{0x20};
  EXPECT_EQ(sentence_of(bytes), "wood.webp: damaged WebP image (the data are inconsistent); export or copy it again");
}

TEST(WebpMalformed, AnimationsAreRefused) {
  std::vector<std::byte> bytes;
  for (const char c : std::string("RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\x02\0\0\0\x07\0\0\x07\0\0", 30))
    bytes.push_back(static_cast<std::byte>(c));
  EXPECT_EQ(sentence_of(bytes), "wood.webp: animated WebP images are not supported; export a single frame");
}

TEST(WebpMalformed, FlippedBitsGiveAnImageOrAnError) {
  const std::vector<uint8_t> rgba = gradient(30, 20);
  for (const std::vector<std::byte>& whole : {make_webp(30, 20, rgba), make_webp(30, 20, rgba, 90)}) {
    for (uint32_t i = 0; i < 300; ++i) {
      std::vector<std::byte> bytes = whole;
      bytes[hash(i) % (i % 2 == 0 ? 40 : bytes.size())] ^= static_cast<std::byte>(1u << (hash(i, 1) & 7u));
      const std::string sentence = sentence_of(bytes);
      EXPECT_TRUE(sentence.empty() || sentence.starts_with("wood.webp: ")) << sentence;
    }
  }
}

}  // namespace
}  // namespace relume
