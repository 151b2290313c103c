#include "relume/image_io.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "core/hash.h"
#include "core/srgb.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"

namespace relume {
namespace {

Image make_gradient(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(width - 1);
      const float v = static_cast<float>(y) / static_cast<float>(height - 1);
      image.at(x, y) = {u, v, 0.5f * (u + v)};
    }
  }
  return image;
}

float max_difference(const Image& a, const Image& b, bool as_srgb) {
  float largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3 d = as_srgb ? srgb_from_linear(a.pixels[i]) - srgb_from_linear(b.pixels[i]) : a.pixels[i] - b.pixels[i];
    largest = std::max(largest, max_component(abs(d)));
  }
  return largest;
}

TEST(Srgb, IsItsOwnInverseAndMatchesTheStandard) {
  // IEC 61966-2-1: linear 0.214041 is display 0.5; the two branches meet at 0.0031308.
  EXPECT_NEAR(srgb_from_linear(0.214041f), 0.5f, 1e-5f);
  EXPECT_NEAR(srgb_from_linear(0.0031308f), 0.04045f, 1e-5f);
  for (int i = 0; i < 256; ++i)
    EXPECT_EQ(quantise_unorm8(srgb_from_linear(linear_from_srgb(static_cast<float>(i) / 255.0f))), i);
  EXPECT_EQ(quantise_unorm8(std::nanf("")), 0);
  EXPECT_EQ(quantise_unorm8(-1.0f), 0);
  EXPECT_EQ(quantise_unorm8(7.0f), 255);
}

TEST(Image, DisplayFormatsRoundTrip) {
  const TempFolder folder;
  const Image image = make_gradient(37, 23);
  for (const char* name : {"a.png", "a.tga", "a.PNG"}) {
    write_image(folder / name, image);
    const Image read = read_image(folder / name);
    ASSERT_EQ(read.width, 37) << name;
    ASSERT_EQ(read.height, 23) << name;
    EXPECT_LE(max_difference(image, read, true), 0.5f / 255.0f + 1e-5f) << name;  // half a step
  }
  write_image(folder / "a.jpg", image);
  EXPECT_LE(max_difference(image, read_image(folder / "a.jpg"), true), 12.0f / 255.0f);  // lossy; smooth, quality 95
}

TEST(Image, HdrKeepsARelativePrecisionOfOneIn256) {
  const TempFolder folder;
  Image image = make_gradient(40, 9);
  for (Rgb& pixel : image.pixels) pixel *= 1000.0f;
  write_image(folder / "a.hdr", image);
  const Image read = read_image(folder / "a.hdr");
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const float step = max_component(image.pixels[i]) / 128.0f;  // 8-bit mantissa of the largest channel, truncated
    EXPECT_LE(max_component(abs(image.pixels[i] - read.pixels[i])), step + 1e-6f);
  }
}

TEST(Image, HdrClampsOutOfRangeValues) {
  const TempFolder folder;
  Image image(2, 1);
  image.at(0, 0) = {-1.0f, std::nanf(""), 2.0f};
  image.at(1, 0) = {kInfinity, 0.0f, 1.0f};
  write_image(folder / "a.hdr", image);
  const Image read = read_image(folder / "a.hdr");
  EXPECT_EQ(read.at(0, 0).r, 0.0f);
  EXPECT_EQ(read.at(0, 0).g, 0.0f);
  EXPECT_NEAR(read.at(0, 0).b, 2.0f, 0.02f);
  EXPECT_GT(read.at(1, 0).r, 1e37f);
  EXPECT_TRUE(is_finite(read.at(1, 0)));
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

TEST(Image, HdrReadsFlatOldAndBottomUpImages) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  const auto pixel = [](int r, int g, int b, int e) {
    return std::string{static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
  };
  const std::string one = pixel(128, 64, 32, 129);  // (1, 0.5, 0.25)
  const std::string two = pixel(128, 0, 0, 130);    // (2, 0, 0)
  const std::string repeat_three = pixel(1, 1, 1, 3);
  const Image flat = parse_image(bytes_of(header + "-Y 2 +X 2\n" + one + two + two + one), "flat");
  EXPECT_EQ(flat.at(0, 0), Rgb(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(flat.at(1, 0), Rgb(2.0f, 0.0f, 0.0f));
  EXPECT_EQ(flat.at(1, 1), Rgb(1.0f, 0.5f, 0.25f));
  const Image old = parse_image(bytes_of(header + "-Y 1 +X 5\n" + one + repeat_three + two), "old");
  EXPECT_EQ(old.at(3, 0), Rgb(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(old.at(4, 0), Rgb(2.0f, 0.0f, 0.0f));
  const Image flipped = parse_image(bytes_of(header + "+Y 2 +X 1\n" + one + two), "flipped");
  EXPECT_EQ(flipped.at(0, 0), Rgb(2.0f, 0.0f, 0.0f));
  // Exposures are factors already applied to the radiance; several multiply.
  const Image exposed = parse_image(bytes_of("#?RADIANCE\nEXPOSURE=0.25\nEXPOSURE= 2\n\n-Y 1 +X 1\n" + one), "exposed");
  EXPECT_EQ(exposed.at(0, 0), Rgb(2.0f, 1.0f, 0.5f));
  for (const std::string& bad :
       {"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n" + one, "#?RADIANCE\nEXPOSURE=x\n\n-Y 1 +X 1\n" + one,
        "#?RADIANCE\nEXPOSURE=-1\n\n-Y 1 +X 1\n" + one, header + "-Y 1 +X 2\n" + one + repeat_three,
        header + "-Y 1 +X 2\n" + repeat_three + one, header + "-Y 1 +X 9999999\n" + one, header + "1 1\n" + one,
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n") + one})
    EXPECT_THROW(parse_image(bytes_of(bad), "bad"), Error) << bad;
}

TEST(Image, ExrKeepsEveryValue) {
  const TempFolder folder;
  const Image image = make_gradient(16, 16);
  write_image(folder / "a.exr", image);
  EXPECT_EQ(max_difference(image, read_image(folder / "a.exr"), false), 0.0f);
}

TEST(Image, IsRecognisedByContent) {
  const TempFolder folder;
  write_image(folder / "a.png", make_gradient(5, 4));
  std::filesystem::rename(folder / "a.png", folder / "a.jpg");
  EXPECT_EQ(read_image(folder / "a.jpg").width, 5);
}

TEST(Image, UnusableInputIsOneSentence) {
  const TempFolder folder;
  EXPECT_THROW(read_image(folder / "missing.png"), Error);
  EXPECT_THROW(write_image(folder / "a.gif", make_gradient(2, 2)), Error);
  EXPECT_THROW(write_image(folder / "a", make_gradient(2, 2)), Error);
  EXPECT_THROW(write_image(folder / "a.png", Image()), Error);
  EXPECT_THROW(write_image(folder / "missing" / "a.png", make_gradient(2, 2)), Error);
  EXPECT_THROW(write_image(folder / "a.jpg", Image(70000, 1)), Error);
  EXPECT_EQ(folder.file_count(), 0u);
  for (const char* contents : {"", "text", "GIF89a", "II*", "RIFF....WEBPVP8 "}) {
    write_file(folder / "b.png", contents);
    EXPECT_THROW(read_image(folder / "b.png"), Error) << contents;
  }
}

TEST(ImageMalformed, TruncatedAndFlippedFilesNeverCrash) {
  const TempFolder folder;
  for (const char* name : {"a.png", "a.jpg", "a.tga", "a.hdr"}) {
    write_image(folder / name, make_gradient(30, 20));
    const auto original = read_file(folder / name);
    for (uint32_t i = 0; i < 400; ++i) {
      auto bytes = original;
      if (i % 2 == 0) {
        bytes.resize(hash(i) % bytes.size());
      } else {
        bytes[hash(i) % (i % 4 == 1 ? 40 : bytes.size())] ^= static_cast<std::byte>(1u << (hash(i, 1) & 7u));
      }
      try {
        const Image image = parse_image(bytes, name);
        EXPECT_GT(image.pixels.size(), 0u);
      } catch (const Error&) {
      }
    }
  }
}

TEST(ImageMalformed, CutOffImagesAreErrors) {
  const TempFolder folder;
  for (const char* name : {"a.png", "a.jpg", "a.tga", "a.hdr"}) {
    write_image(folder / name, make_gradient(30, 20));
    const auto bytes = read_file(folder / name);
    for (size_t size = 0; size + 1 < bytes.size(); size += 1 + bytes.size() / 50)
      EXPECT_THROW(parse_image({bytes.data(), size}, name), Error) << name << ' ' << size;
  }
}

TEST(ImageMalformed, TheEndOfAThumbnailIsNotThatOfTheImage) {
  const TempFolder folder;
  write_image(folder / "a.jpg", make_gradient(30, 20));
  const auto image = read_file(folder / "a.jpg");
  // An application segment with a small image, after the first marker.
  std::vector<std::byte> bytes(image.begin(), image.begin() + 2);
  const size_t length = image.size() + 2;
  for (const size_t byte : {size_t{0xff}, size_t{0xe1}, length >> 8, length & 0xff}) bytes.push_back(std::byte(byte));
  bytes.insert(bytes.end(), image.begin(), image.end());
  bytes.insert(bytes.end(), image.begin() + 2, image.end());
  EXPECT_NO_THROW(parse_image(bytes, "a.jpg"));
  EXPECT_THROW(parse_image({bytes.data(), bytes.size() - 20}, "a.jpg"), Error);
  for (const unsigned char byte : {0x00, 0xff, 0xda, 0x12, 0x34}) bytes.push_back(std::byte(byte));
  EXPECT_NO_THROW(parse_image(bytes, "a.jpg")) << "what follows the end is none of the image's";
}

TEST(ImageMalformed, CutOffBitmapsAreErrors) {
  // 3 × 2, 24 bits per pixel; rows are padded to twelve bytes.
  std::vector<unsigned char> bmp{'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0,  40,
                                 0,   0,   0, 3, 0, 0, 0, 2, 0, 0, 0,  1, 0, 24, 0};
  bmp.resize(54 + 24, 0);
  const std::span bytes = std::as_bytes(std::span(bmp));
  EXPECT_EQ(parse_image(bytes, "a.bmp").width, 3);
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(parse_image(bytes.first(size), "a.bmp"), Error) << size;
}

TEST(ImageMalformed, IndicesWithoutAColourAreErrors) {
  // 2 × 1, four bits per pixel, three colours.
  std::vector<unsigned char> bmp{'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, 66, 0, 0, 0, 40,
                                 0,   0,   0, 2, 0, 0, 0, 1, 0, 0, 0,  1, 0, 4, 0};
  bmp.resize(66, 0);
  bmp[46] = 3;
  for (const unsigned char indices : {0x02, 0x12, 0x22}) {
    std::vector<unsigned char> file = bmp;
    file.insert(file.end(), {indices, 0, 0, 0});
    EXPECT_NO_THROW(parse_image(std::as_bytes(std::span(file)), "a.bmp")) << int{indices};
    file[66] = static_cast<unsigned char>(indices + 0x01);
    EXPECT_THROW(parse_image(std::as_bytes(std::span(file)), "a.bmp"), Error) << int{indices};
  }
}

TEST(ImageMalformed, AbsurdPngSizeIsRefused) {
  const TempFolder folder;
  write_image(folder / "a.png", make_gradient(30, 20));
  auto bytes = read_file(folder / "a.png");
  for (const auto& [high, low] : {std::pair{0x00, 0xff}, std::pair{0x00, 0x7f}, std::pair{0x7f, 0xff}}) {
    for (const size_t at : {size_t{16}, size_t{20}}) {  // width and height in IHDR, big-endian
      bytes[at] = static_cast<std::byte>(high);
      bytes[at + 1] = static_cast<std::byte>(0);
      bytes[at + 2] = static_cast<std::byte>(low);
      bytes[at + 3] = static_cast<std::byte>(low);
    }
    EXPECT_THROW(parse_image(bytes, "huge.png"), Error) << high << ' ' << low;
  }
}

}  // namespace
}  // namespace relume
