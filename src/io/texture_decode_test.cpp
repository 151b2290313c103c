#include "io/texture_decode.h"

#include <cstring>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/srgb.h"
#include "io/atomic_file.h"
#include "io/image.h"
#include "io/temp_folder.h"

namespace relume {
namespace {

/// An uncompressed PNG (ISO/IEC 15948). `samples` are big-endian rows without filter bytes; checksums are left zero,
/// which the decoder does not look at.
std::vector<std::byte> make_png(uint32_t width, uint32_t height, int bit_depth, int color_type,
                                const std::vector<uint8_t>& samples) {
  std::string raw;
  const size_t row = samples.size() / height;
  for (uint32_t y = 0; y < height; ++y) {
    raw.push_back('\0');  // filter: none
    raw.append(samples.begin() + static_cast<std::ptrdiff_t>(y * row),
               samples.begin() + static_cast<std::ptrdiff_t>((y + 1) * row));
  }
  const auto big_endian = [](uint32_t x) {
    return std::string{static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8),
                       static_cast<char>(x)};
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return big_endian(static_cast<uint32_t>(data.size())) + type + data + big_endian(0);
  };
  const auto n = static_cast<uint16_t>(raw.size());
  const auto m = static_cast<uint16_t>(~n);
  std::string zlib{0x78, 0x01, 0x01};  // one stored block
  for (const uint16_t x : {n, m}) zlib += {static_cast<char>(x & 255), static_cast<char>(x >> 8)};
  zlib += raw + big_endian(0);
  const std::string header = big_endian(width) + big_endian(height) +
                             std::string{static_cast<char>(bit_depth), static_cast<char>(color_type), 0, 0, 0};
  const std::string file = "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", zlib) + chunk("IEND", "");
  std::vector<std::byte> bytes(file.size());
  std::memcpy(bytes.data(), file.data(), file.size());
  return bytes;
}

constexpr int kGrey = 0;
constexpr int kRgba = 6;

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

TEST(TextureDecode, FloatIsDecodedFromSrgbButForAlpha) {
  const Texture texture = decode_texture(make_png(1, 1, 8, kRgba, {188, 0, 255, 128}), "t", PixelFormat::rgba32_float);
  const std::vector<float> values = floats(texture);
  EXPECT_FLOAT_EQ(values.at(0), linear_from_srgb(188.0f / 255.0f));
  EXPECT_FLOAT_EQ(values.at(2), 1.0f);
  EXPECT_FLOAT_EQ(values.at(3), 128.0f / 255.0f);
}

TEST(TextureDecode, ExrAndHdrAreFloatWhateverIsWanted) {
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

TEST(TextureDecode, GarbageIsAnErrorThatNamesTheTexture) {
  const std::vector<std::byte> garbage(100, std::byte{0x42});
  try {
    decode_texture(garbage, "wood.png", PixelFormat::rgba8_srgb);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).rfind("wood.png: ", 0), 0u) << e.what();
  }
}

}  // namespace
}  // namespace relume
