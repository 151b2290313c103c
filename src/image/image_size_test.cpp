#include "image/image_size.h"

#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "image/ktx2/testing/ktx2_file.h"
#include "image/testing/webp.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

void expect_size(std::span<const std::byte> bytes, const std::string& name) {
  const Image image = parse_image(bytes, name);
  const detail::ImageSize size = detail::read_image_size(bytes, name);
  EXPECT_EQ(size.width, image.width) << name;
  EXPECT_EQ(size.height, image.height) << name;
}

TEST(ImageSize, MatchesTheDecodedImage) {
  const TempFolder folder;
  for (const char* name : {"a.exr", "a.hdr", "a.png", "a.jpg", "a.tga"}) {
    write_image(folder / name, Image(9, 5));
    expect_size(read_file(folder / name), name);
  }
  expect_size(testing::plain_ktx2().bytes(), "a.ktx2");
  const std::vector<uint8_t> white(4 * 7 * 3, 255);
  expect_size(testing::make_webp(7, 3, white), "lossless.webp");
  expect_size(testing::make_webp(7, 3, white, 80), "lossy.webp");
}

TEST(ImageSize, OfExrFilesIsTheDisplayWindow) {
  const TempFolder folder;
  write_exr(folder / "a.exr", {4, 3, exr_channels(Image(4, 3)), {}, {.x = 1, .y = 1, .width = 2, .height = 1}});
  expect_size(read_file(folder / "a.exr"), "a.exr");
}

TEST(ImageSize, BmpRowsFromAboveHaveAPositiveHeight) {
  std::vector<std::byte> bytes(14 + 40 + 2 * 4);
  const auto set = [&](size_t at, uint32_t value) {
    for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::byte>(value >> (8 * i));
  };
  bytes[0] = std::byte{'B'};
  bytes[1] = std::byte{'M'};
  set(10, 54);
  set(14, 40);
  set(18, 1);
  set(22, static_cast<uint32_t>(-2));
  set(26, 1 | 24 << 16);
  expect_size(bytes, "a.bmp");
}

TEST(ImageSize, TruncatedHeadersGiveOneSentence) {
  const TempFolder folder;
  for (const char* name : {"a.exr", "a.hdr", "a.png", "a.jpg", "a.tga"}) {
    write_image(folder / name, Image(9, 5));
    const std::vector<std::byte> bytes = read_file(folder / name);
    try {
      detail::read_image_size(std::span(bytes).first(16), name);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(std::string(name) + ": ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace relume
