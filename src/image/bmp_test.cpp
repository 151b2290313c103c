#include "image/bmp.h"

#include <random>

#include <gtest/gtest.h>

#include "relume/error.h"
#include "scene/testing/plate.h"

namespace relume::detail {
namespace {

using relume::testing::problem_of;

/// A BMP file with individually settable fields.
struct Bmp {
  uint32_t header_size = 40;
  int32_t width = 2;
  int32_t height = 2;
  uint16_t depth = 24;
  uint32_t compression = 0;
  std::vector<uint32_t> masks;  ///< after the first 40 bytes of the header
  std::vector<uint8_t> palette;
  std::vector<uint8_t> pixels;

  std::vector<std::byte> bytes() const {
    std::vector<uint8_t> file = {'B', 'M'};
    const auto put = [&](uint64_t value, int size) {
      for (int i = 0; i < size; ++i, value >>= 8) file.push_back(static_cast<uint8_t>(value));
    };
    const int field = header_size == 12 ? 2 : 4;
    for (int i = 0; i < 3; ++i) put(0, 4);  // the last: offset of the pixels
    put(header_size, 4);
    put(static_cast<uint32_t>(width), field);
    put(static_cast<uint32_t>(height), field);
    put(1, 2);
    put(depth, 2);
    if (header_size >= 40) {
      put(compression, 4);
      put(0, 20);
    }
    for (const uint32_t mask : masks) put(mask, 4);
    while (file.size() < 14 + header_size) file.push_back(0);
    file.insert(file.end(), palette.begin(), palette.end());
    for (size_t i = 0; i < 4; ++i) file[10 + i] = static_cast<uint8_t>(file.size() >> (8 * i));
    file.insert(file.end(), pixels.begin(), pixels.end());
    const auto bytes = std::as_bytes(std::span(file));
    return {bytes.begin(), bytes.end()};
  }
};

std::vector<uint8_t> decode(const Bmp& bmp) { return decode_bmp(bmp.bytes(), "a.bmp").rgba8; }

/// A palette of `count` colours: red = index, the rest 0.
std::vector<uint8_t> reds(int count, int entry_bytes) {
  std::vector<uint8_t> palette;
  for (int i = 0; i < count; ++i) {
    palette.insert(palette.end(), {0, 0, static_cast<uint8_t>(i)});
    if (entry_bytes == 4) palette.push_back(0);
  }
  return palette;
}

std::vector<int> red_of(const std::vector<uint8_t>& rgba) {
  std::vector<int> red;
  for (size_t i = 0; i < rgba.size(); i += 4) red.push_back(rgba[i]);
  return red;
}

using Reds = std::vector<int>;

TEST(Bmp, ReadsBottomUpAndTopDownRows) {
  Bmp bmp;
  bmp.pixels = {1, 2, 3, 4, 5, 6, 0, 0, 7, 8, 9, 10, 11, 12, 0, 0};
  EXPECT_EQ(decode(bmp), (std::vector<uint8_t>{9, 8, 7, 255, 12, 11, 10, 255, 3, 2, 1, 255, 6, 5, 4, 255}));
  bmp.height = -2;
  const DecodedPixels from_above = decode_bmp(bmp.bytes(), "a.bmp");
  EXPECT_EQ(from_above.height, 2);
  EXPECT_EQ(from_above.rgba8, (std::vector<uint8_t>{3, 2, 1, 255, 6, 5, 4, 255, 9, 8, 7, 255, 12, 11, 10, 255}));
  bmp.height = std::numeric_limits<int32_t>::min();
  EXPECT_THROW(decode(bmp), Error);
}

TEST(Bmp, ExpandsRunLengths) {
  Bmp bmp;
  bmp.width = 6;
  bmp.height = 3;
  bmp.depth = 8;
  bmp.compression = 1;
  bmp.palette = reds(20, 4);
  // A run; three padded literals; end of row; a move by two to the right and one up; an overlong run; end.
  bmp.pixels = {3, 7, 0, 3, 1, 2, 3, 0, 0, 0, 0, 2, 2, 1, 9, 5, 0, 1};
  EXPECT_EQ(red_of(decode(bmp)), (Reds{0, 0, 5, 5, 5, 5, 0, 0, 0, 0, 0, 0, 7, 7, 7, 1, 2, 3}));
  bmp.depth = 4;
  bmp.compression = 2;
  bmp.palette = reds(16, 4);
  bmp.pixels = {5, 0x12, 0, 0, 0, 3, 0x34, 0x50, 2, 0x67, 0, 1};
  EXPECT_EQ(red_of(decode(bmp)), (Reds{0, 0, 0, 0, 0, 0, 3, 4, 5, 6, 7, 0, 1, 2, 1, 2, 1, 0}));
  for (size_t size = 0; size + 2 < bmp.pixels.size(); ++size) {
    Bmp cut = bmp;
    cut.pixels.resize(size);
    EXPECT_NE(problem_of([&] { decode(cut); }).find("cut off"), std::string::npos) << size;
  }
}

TEST(Bmp, AcceptsRunLengthsThatEndAfterTheLastPixel) {
  Bmp bmp;
  bmp.width = 3;
  bmp.height = 2;
  bmp.depth = 8;
  bmp.compression = 1;
  bmp.palette = reds(20, 4);
  const Reds expected = {8, 8, 8, 7, 7, 7};
  bmp.pixels = {3, 7, 0, 0, 3, 8};
  EXPECT_EQ(red_of(decode(bmp)), expected);
  bmp.pixels = {3, 7, 0, 0, 3, 8, 0};
  EXPECT_EQ(red_of(decode(bmp)), expected) << "half of a marker";
  bmp.pixels = {3, 7, 0, 0, 0, 3, 8, 8, 8, 0};
  EXPECT_EQ(red_of(decode(bmp)), expected) << "literals";
  const std::vector<std::vector<uint8_t>> incomplete = {{3, 7}, {3, 7, 0, 0}, {3, 7, 0, 0, 2, 8}};
  for (const std::vector<uint8_t>& pixels : incomplete) {
    bmp.pixels = pixels;
    EXPECT_NE(problem_of([&] { decode(bmp); }).find("cut off"), std::string::npos) << pixels.size();
  }
}

TEST(Bmp, ReadsMasksOfEveryHeader) {
  Bmp bmp;
  bmp.width = 1;
  bmp.height = 1;
  bmp.depth = 32;
  bmp.compression = 3;
  bmp.pixels = {10, 20, 30, 40};
  const std::vector<uint32_t> masks = {0xff, 0xff00, 0xff0000, 0xff000000};
  for (const uint32_t size : {40u, 52u, 56u, 108u, 124u}) {
    bmp.header_size = size;
    bmp.masks = masks;
    if (size < 56) bmp.masks.pop_back();
    const uint8_t alpha = size < 56 ? 255 : 40;
    if (size == 40) bmp.palette.clear();
    EXPECT_EQ(decode(bmp), (std::vector<uint8_t>{10, 20, 30, alpha})) << size;
  }
  bmp.masks = {0x3ff00000, 0xffc00, 0x3ff, 0xc0000000};
  bmp.pixels = {0xff, 0x03, 0x00, 0xc0};
  EXPECT_EQ(decode(bmp), (std::vector<uint8_t>{0, 0, 255, 255})) << "ten bits";
  bmp.depth = 16;
  bmp.masks = {0xf800, 0x7e0, 0x1f, 0};
  bmp.pixels = {0x43, 0x18, 0, 0};  // 3, 2, 3
  EXPECT_EQ(decode(bmp), (std::vector<uint8_t>{24, 8, 24, 255}));
  bmp.masks[1] = 0;
  EXPECT_NE(problem_of([&] { decode(bmp); }).find("no mask"), std::string::npos);
}

TEST(Bmp, KeepsUsedAlpha) {
  Bmp bmp;
  bmp.width = 2;
  bmp.height = 1;
  bmp.depth = 32;
  bmp.pixels = {1, 2, 3, 0, 4, 5, 6, 0};
  EXPECT_EQ(decode(bmp), (std::vector<uint8_t>{3, 2, 1, 255, 6, 5, 4, 255}));
  bmp.pixels[3] = 9;
  EXPECT_EQ(decode(bmp), (std::vector<uint8_t>{3, 2, 1, 9, 6, 5, 4, 0}));
}

TEST(Bmp, ReadsHeadersOfOs2) {
  Bmp bmp;
  bmp.width = 2;
  bmp.height = 1;
  bmp.depth = 8;
  bmp.pixels = {255, 7, 0, 0};
  for (const uint32_t size : {12u, 16u, 64u}) {
    bmp.header_size = size;
    bmp.palette = reds(256, size == 12 ? 3 : 4);
    EXPECT_EQ(red_of(decode(bmp)), (Reds{255, 7})) << size;
  }
  bmp.depth = 1;
  bmp.palette = reds(2, 4);
  bmp.pixels = {0x40, 0, 0, 0};
  EXPECT_EQ(red_of(decode(bmp)), (Reds{0, 1}));
}

TEST(Bmp, ErrorsNameUnsupportedFeatures) {
  const auto problem = [](uint32_t header_size, uint32_t compression, uint16_t depth) {
    Bmp bmp;
    bmp.header_size = header_size;
    bmp.compression = compression;
    bmp.depth = depth;
    bmp.pixels.resize(64);
    return problem_of([&] { decode(bmp); });
  };
  EXPECT_EQ(problem(40, 4, 24), "a.bmp: BMP images with a JPEG inside are not supported; save it as PNG");
  EXPECT_NE(problem(40, 5, 24).find("a PNG inside"), std::string::npos);
  EXPECT_NE(problem(64, 3, 1).find("Huffman compression"), std::string::npos);
  EXPECT_NE(problem(64, 4, 24).find("run lengths of 24-bit pixels"), std::string::npos);
  EXPECT_NE(problem(40, 11, 32).find("compression 11"), std::string::npos);
  EXPECT_NE(problem(40, 0, 2).find("2 bits per pixel"), std::string::npos);
  EXPECT_NE(problem(128, 0, 24).find("a header of 128 bytes"), std::string::npos);
  EXPECT_NE(problem(40, 1, 24).find("damaged"), std::string::npos);
}

TEST(Bmp, ArraysOfOs2AreNotSupported) {
  const std::vector<std::byte> bitmap = Bmp().bytes();
  std::vector<std::byte> bytes(14);
  bytes[0] = std::byte{'B'};
  bytes[1] = std::byte{'A'};
  bytes.insert(bytes.end(), bitmap.begin(), bitmap.end());
  EXPECT_EQ(detect_image_format(bytes, "a.bmp"), ImageFormat::bmp);
  const std::string sentence = "a.bmp: BMP images with an OS/2 array of bitmaps are not supported; save it as PNG";
  EXPECT_EQ(problem_of([&] { decode_bmp(bytes, "a.bmp"); }), sentence);
  EXPECT_EQ(problem_of([&] { bmp_size(bytes, "a.bmp"); }), sentence);
}

TEST(Bmp, RandomBytesGiveAnImageOrAnError) {
  Bmp rle;
  rle.width = 6;
  rle.height = 3;
  rle.depth = 8;
  rle.compression = 1;
  rle.palette = reds(20, 4);
  rle.pixels = {3, 7, 0, 3, 1, 2, 3, 0, 0, 0, 0, 2, 2, 1, 4, 5, 0, 1};
  const std::vector<std::byte> valid = rle.bytes();
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> bytes = valid;
    for (uint32_t changes = 1 + random() % 4; changes > 0; --changes)
      bytes[random() % (random() % 2 == 0 ? 54 : bytes.size())] = static_cast<std::byte>(random());
    try {
      const DecodedPixels pixels = decode_bmp(bytes, "a.bmp");
      EXPECT_EQ(pixels.rgba8.size(),
                size_t{4} * static_cast<size_t>(pixels.width) * static_cast<size_t>(pixels.height));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace relume::detail
