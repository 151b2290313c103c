#include "scene_io/texture_decode.h"

#include <cstring>

#include <gtest/gtest.h>

#include "core/srgb.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "image/ktx2/testing/ktx2_file.h"
#include "image/testing/png.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

using testing::kGrey;
using testing::kRgba;
using testing::make_png;

std::vector<float> floats(const Texture& texture) {
  std::vector<float> values(texture.texels.size() / 4);
  std::memcpy(values.data(), texture.texels.data(), texture.texels.size());
  return values;
}

TEST(TextureDecode, EightBitIsKeptAsStored) {
  const std::vector<uint8_t> samples{1, 2, 3, 4, 250, 251, 252, 253};
  const auto bytes = make_png(2, 1, 8, kRgba, samples);
  for (const PixelFormat wanted : {PixelFormat::rgba8_srgb, PixelFormat::rgba8_linear}) {
    const Texture texture = decode_texture(bytes, "t", wanted);
    EXPECT_EQ(texture.name, "t");
    EXPECT_EQ(texture.width, 2);
    EXPECT_EQ(texture.height, 1);
    EXPECT_EQ(texture.format, wanted);
    ASSERT_EQ(texture.texels.size(), samples.size());
    EXPECT_EQ(std::memcmp(texture.texels.data(), samples.data(), samples.size()), 0);
  }
}

TEST(TextureDecode, Ktx2IsKeptAsStored) {
  testing::Ktx2File file = testing::plain_ktx2();
  for (const PixelFormat wanted : {PixelFormat::rgba8_srgb, PixelFormat::rgba8_linear}) {
    const Texture texture = decode_texture(file.bytes(), "t", wanted);
    EXPECT_EQ(texture.format, wanted);
    EXPECT_EQ(texture.texels, file.levels[0]);
  }
  EXPECT_FLOAT_EQ(floats(decode_texture(file.bytes(), "t", PixelFormat::rgba32_float))[0],
                  linear_from_srgb(10 / 255.0f));
  file.format = 37;
  file.transfer = 1;
  EXPECT_FLOAT_EQ(floats(decode_texture(file.bytes(), "t", PixelFormat::rgba32_float))[0], 10 / 255.0f);
}

TEST(TextureDecode, GreyIsReplicatedAndOpaque) {
  const Texture texture = decode_texture(make_png(1, 1, 8, kGrey, {77}), "t", PixelFormat::rgba8_srgb);
  EXPECT_EQ(texture.texels, (std::vector<std::byte>{std::byte{77}, std::byte{77}, std::byte{77}, std::byte{255}}));
}

TEST(TextureDecode, SixteenBitDataKeepsItsPrecisionAndColourIsRounded) {
  const auto bytes = make_png(1, 1, 16, kRgba, {0x80, 0x01, 0x00, 0x40, 0xff, 0xff, 0x12, 0x34});
  const Texture data = decode_texture(bytes, "t", PixelFormat::rgba8_linear);
  EXPECT_EQ(data.format, PixelFormat::rgba32_float);
  const float expected[] = {0x8001 / 65535.0f, 0x0040 / 65535.0f, 1.0f, 0x1234 / 65535.0f};
  ASSERT_EQ(data.texels.size(), sizeof(expected));
  for (size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(floats(data)[i], expected[i]);
  const Texture color = decode_texture(bytes, "t", PixelFormat::rgba8_srgb);
  EXPECT_EQ(color.format, PixelFormat::rgba8_srgb);
  EXPECT_EQ(color.texels, (std::vector<std::byte>{std::byte{128}, std::byte{0}, std::byte{255}, std::byte{18}}));
}

TEST(TextureDecode, FloatIsDecodedFromSrgbExceptAlpha) {
  const Texture texture = decode_texture(make_png(1, 1, 8, kRgba, {188, 0, 255, 128}), "t", PixelFormat::rgba32_float);
  const std::vector<float> values = floats(texture);
  EXPECT_FLOAT_EQ(values.at(0), linear_from_srgb(188.0f / 255.0f));
  EXPECT_FLOAT_EQ(values.at(2), 1.0f);
  EXPECT_FLOAT_EQ(values.at(3), 128.0f / 255.0f);
}

TEST(TextureDecode, ExrAndHdrAreAlwaysFloat) {
  const TempFolder folder;
  ExrFile exr;
  exr.width = exr.height = 1;
  exr.channels = {{"R", {4.0f}}, {"G", {5.0f}}, {"B", {6.0f}}, {"A", {0.25f}}};
  write_exr(folder / "a.exr", exr);
  const Texture from_exr = decode_texture(read_file(folder / "a.exr"), "t", PixelFormat::rgba8_srgb);
  EXPECT_EQ(from_exr.format, PixelFormat::rgba32_float);
  EXPECT_EQ(floats(from_exr), (std::vector<float>{4.0f, 5.0f, 6.0f, 0.25f}));
  Image image(1, 1);
  image.at(0, 0) = Rgb(4.0f, 2.0f, 1.0f);  // exact in the shared-exponent format
  write_image(folder / "a.hdr", image);
  const Texture from_hdr = decode_texture(read_file(folder / "a.hdr"), "t", PixelFormat::rgba8_srgb);
  EXPECT_EQ(from_hdr.format, PixelFormat::rgba32_float);
  EXPECT_EQ(floats(from_hdr), (std::vector<float>{4.0f, 2.0f, 1.0f, 1.0f}));
}

TEST(TextureDecode, PngChunksBeyondTheFileAreRefusedBeforeTheyAreAllocated) {
  auto bytes = make_png(2, 1, 8, kRgba, {1, 2, 3, 4, 5, 6, 7, 8});
  constexpr size_t kIdatLength = 8 + 25;  // after the signature and IHDR with its header and checksum
  bytes[kIdatLength] = std::byte{0x3f};   // about 1 GiB
  try {
    decode_texture(bytes, "wood.png", PixelFormat::rgba8_srgb);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("cut off"), std::string::npos) << e.what();
  }
}

TEST(TextureDecode, GarbageIsAnErrorThatNamesTheTexture) {
  const std::vector<std::byte> garbage(100, std::byte{0x42});
  try {
    decode_texture(garbage, "wood.png", PixelFormat::rgba8_srgb);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).rfind("wood.png: ", 0), 0u) << e.what();
  }
}

TEST(DecodeBudget, GrowsWithTheFiles) {
  constexpr uint64_t kFree = DecodeBudget::kFreeTexels;
  DecodeBudget budget;
  EXPECT_TRUE(budget.take(kFree - 64, 0));
  EXPECT_FALSE(budget.take(65, 0));
  EXPECT_TRUE(budget.take(64, 0)) << "what does not fit takes nothing";
  EXPECT_FALSE(budget.take(1, 0));
  EXPECT_TRUE(budget.take(DecodeBudget::kTexelsPerByte, 1));
  EXPECT_FALSE(budget.take(1, 0));
  EXPECT_FALSE(DecodeBudget().take(kFree + 65, 1));
}

TEST(TextureDecode, FloatsAreRepaired) {
  const float nan = std::nanf("");
  for (const PixelFormat wanted : {PixelFormat::rgba8_srgb, PixelFormat::rgba8_linear}) {
    const bool is_data = wanted == PixelFormat::rgba8_linear;
    Texture texture;
    texture.format = PixelFormat::rgba32_float;
    const std::vector<float> given{nan, -1, kInfinity, 1, 0.25f, 7, -kInfinity, 0.5f};
    const std::vector<float> expected{0, 0, is_data ? 1 : 1e15f, 1, 0.25f, is_data ? 1.0f : 7.0f, 0, 0.5f};
    texture.texels.resize(given.size() * sizeof(float));
    std::memcpy(texture.texels.data(), given.data(), texture.texels.size());
    const std::string sentence = repair_texels(texture, "sky.exr", wanted);
    EXPECT_EQ(floats(texture), expected);
    EXPECT_NE(sentence.find(is_data ? "sky.exr: 5 values" : "sky.exr: 4 values"), std::string::npos) << sentence;
    EXPECT_TRUE(repair_texels(texture, "sky.exr", wanted).empty());
  }
}

}  // namespace
}  // namespace relume
