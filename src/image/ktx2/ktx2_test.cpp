#include "image/ktx2/ktx2.h"

#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "image/ktx2/testing/ktx2_file.h"
#include "relume/error.h"
#include "scene/testing/plate.h"

namespace relume::detail {
namespace {

using relume::testing::byte_list;
using relume::testing::Ktx2File;
using relume::testing::plain_ktx2;
using relume::testing::problem_of;
using relume::testing::small_etc1s_ktx2;
using relume::testing::uastc_ktx2;
using relume::testing::with_zstandard;

using Texels = std::vector<uint8_t>;

Ktx2Image decode(const Ktx2File& file) { return decode_ktx2(file.bytes(), "a.ktx2"); }

std::string problem(const Ktx2File& file) {
  return problem_of([&] { decode(file); });
}

/// Error message after a change to the file.
std::string problem_after(Ktx2File file, const std::function<void(Ktx2File&)>& change) {
  change(file);
  return problem(file);
}

/// RGBA of a texel.
Texels texel(const Ktx2Image& image, int x, int y) {
  const auto first = image.rgba8.begin() + 4 * (y * image.width + x);
  return {first, first + 4};
}

/// One file of each kind.
std::vector<Ktx2File> all_kinds() {
  return {plain_ktx2(),
          with_zstandard(plain_ktx2()),
          uastc_ktx2(),
          with_zstandard(uastc_ktx2()),
          small_etc1s_ktx2(false),
          small_etc1s_ktx2(true)};
}

TEST(Ktx2, ReadsPlainFormats) {
  Ktx2File file = plain_ktx2();
  const Ktx2Image rgba = decode(file);
  EXPECT_EQ(rgba.width, 2);
  EXPECT_EQ(rgba.height, 2);
  EXPECT_EQ(rgba.rgba8, (Texels{10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25}));
  EXPECT_TRUE(rgba.is_srgb);
  EXPECT_TRUE(rgba.has_alpha);
  const std::vector<std::pair<uint32_t, Texels>> first_texels = {
      {9, {10, 0, 0, 255}}, {16, {10, 11, 0, 255}}, {23, {10, 11, 12, 255}}, {37, {10, 11, 12, 13}}};
  for (size_t channels = 1; channels <= 4; ++channels) {
    const auto& [linear_format, first_texel] = first_texels[channels - 1];
    file.levels[0] = plain_ktx2().levels[0];
    file.levels[0].resize(4 * channels);
    file.uncompressed_bytes = {4 * channels};
    for (const bool srgb : {false, true}) {
      file.format = srgb ? linear_format + 6 : linear_format;
      file.transfer = srgb ? 2 : 1;
      const Ktx2Image image = decode(file);
      EXPECT_EQ(texel(image, 0, 0), first_texel);
      EXPECT_EQ(image.is_srgb, srgb);
      EXPECT_EQ(image.has_alpha, channels == 4);
      EXPECT_EQ(decode(with_zstandard(file)).rgba8, image.rgba8);
    }
  }
}

TEST(Ktx2, ReadsUastc) {
  Ktx2File file = uastc_ktx2();
  const Ktx2Image image = decode(file);
  EXPECT_EQ(texel(image, 0, 0), (Texels{60, 70, 80, 90}));
  EXPECT_EQ(texel(image, 7, 3), (Texels{61, 71, 81, 91}));
  EXPECT_EQ(texel(image, 0, 4), (Texels{62, 72, 82, 92}));
  EXPECT_EQ(texel(image, 7, 7), (Texels{63, 73, 83, 93}));
  EXPECT_TRUE(image.has_alpha);
  EXPECT_EQ(decode(with_zstandard(file)).rgba8, image.rgba8);
  struct Case {
    uint8_t channel;
    Texels first_texel;
  };
  for (const Case& c :
       {Case{0, {60, 70, 80, 255}}, Case{4, {60, 70, 80, 255}}, Case{5, {60, 90, 0, 255}}, Case{6, {60, 70, 0, 255}}}) {
    file.channels = {c.channel};
    EXPECT_EQ(texel(decode(file), 0, 0), c.first_texel) << int{c.channel};
    EXPECT_FALSE(decode(file).has_alpha);
  }
}

TEST(Ktx2, ReadsEtc1s) {
  const Ktx2Image opaque = decode(small_etc1s_ktx2(false));
  EXPECT_EQ(opaque.width, 9);
  EXPECT_EQ(opaque.height, 7);
  EXPECT_FALSE(opaque.has_alpha);
  // Block (0, 0): base (255, 0, 82), modifiers −29, −9, 9, 29; its rows are 3, 2, 1, 0 and 0, 1, 2, 3.
  EXPECT_EQ(texel(opaque, 0, 0), (Texels{255, 29, 111, 255}));
  EXPECT_EQ(texel(opaque, 3, 0), (Texels{226, 0, 53, 255}));
  EXPECT_EQ(texel(opaque, 1, 1), (Texels{246, 0, 73, 255}));
  // Block (2, 1): the same endpoint; its first row is 2, 0, 1, 0.
  EXPECT_EQ(texel(opaque, 8, 4), (Texels{255, 9, 91, 255}));
  const Ktx2Image image = decode(small_etc1s_ktx2(true));
  EXPECT_TRUE(image.has_alpha);
  // The alpha of block (1, 0): base 165, modifiers −60, −18, 18, 60; its first row is 2, 0, 1, 0.
  EXPECT_EQ(image.rgba8[4 * 4 + 3], 183);
  EXPECT_EQ(image.rgba8[4 * 5 + 3], 105);
  EXPECT_EQ(image.rgba8[4 * 6 + 3], 147);
  for (size_t i = 0; i < image.rgba8.size(); ++i) {
    EXPECT_EQ(opaque.rgba8[i], i % 4 == 3 ? 255 : image.rgba8[i]);
  }
}

TEST(Ktx2, TwoEtc1sChannelsAreRedAndGreen) {
  Ktx2File file = small_etc1s_ktx2(true);
  const Ktx2Image image = decode(file);
  file.channels = {3, 4};
  const Ktx2Image two = decode(file);
  EXPECT_FALSE(two.has_alpha);
  file.key_values = {{"KTXswizzle", "ra01"}};
  EXPECT_EQ(decode(file).rgba8, two.rgba8) << "the swizzle of what is stored";
  for (int y = 0; y < two.height; ++y) {
    for (int x = 0; x < two.width; ++x) {
      const Texels stored = texel(image, x, y);
      EXPECT_EQ(texel(two, x, y), (Texels{stored[0], stored[3], 0, 255})) << x << ", " << y;
    }
  }
}

TEST(Ktx2, DecodesTheLargestLevel) {
  Ktx2File file = plain_ktx2();
  file.levels.push_back(byte_list({1, 2, 3, 4}));
  file.uncompressed_bytes.push_back(4);
  EXPECT_EQ(decode(file).rgba8, decode(plain_ktx2()).rgba8);
  file = small_etc1s_ktx2(false);
  file.levels.push_back(file.levels[0]);
  file.uncompressed_bytes.push_back(0);
  const std::vector<std::byte> description(file.global_data.begin() + 20, file.global_data.begin() + 40);
  file.global_data.insert(file.global_data.begin() + 40, description.begin(), description.end());
  EXPECT_EQ(decode(file).rgba8, decode(small_etc1s_ktx2(false)).rgba8);
}

TEST(Ktx2, MetadataRearrangesChannels) {
  Ktx2File file = plain_ktx2();
  const Texels as_stored = decode(file).rgba8;
  file.key_values = {{"KTXorientation", "ru"}, {"KTXwriter", "a program"}};
  EXPECT_EQ(decode(file).rgba8, as_stored) << "an orientation does not move texels";
  file.key_values.push_back({"KTXswizzle", "bg01"});
  EXPECT_EQ(texel(decode(file), 0, 0), (Texels{12, 11, 0, 255}));
  EXPECT_FALSE(decode(file).has_alpha);
  file.key_values.back().second = "000r";
  EXPECT_EQ(texel(decode(file), 1, 0), (Texels{0, 0, 0, 14}));
  EXPECT_TRUE(decode(file).has_alpha);
  for (const char* swizzle : {"rgb", "rgbaa", "rgbx"}) {
    file.key_values.back().second = swizzle;
    EXPECT_NE(problem(file).find("KTXswizzle"), std::string::npos) << swizzle;
  }
}

TEST(Ktx2, ErrorsNameUnsupportedFeatures) {
  const auto plain = [](const std::function<void(Ktx2File&)>& change) { return problem_after(plain_ktx2(), change); };
  EXPECT_EQ(
      plain([](Ktx2File& f) { f.format = 97; }),
      "a.ktx2: KTX2 images with VkFormat 97 are not supported; convert it to a 2D texture in UASTC, ETC1S or 8-bit "
      "RGBA");
  EXPECT_NE(plain([](Ktx2File& f) { f.depth = 4; }).find("pixelDepth 4 (3D textures)"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.layers = 3; }).find("layerCount 3 (array textures)"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.faces = 6; }).find("faceCount 6 (cube maps)"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.height = 0; }).find("pixelHeight 0 (1D textures)"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.supercompression = 3; }).find("supercompression 3 (ZLIB)"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.supercompression = 9; }).find("supercompression 9"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.transfer = 10; }).find("transfer function 10"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.flags = 1; }).find("premultiplied alpha"), std::string::npos);
  const auto undefined = [](Ktx2File& f) {
    f.format = 0;
    f.model = 167;
  };
  EXPECT_NE(plain(undefined).find("colour model 167"), std::string::npos);
  const auto predicted = [](Ktx2File& f) { f.global_data[20] = std::byte{2}; };
  EXPECT_NE(problem_after(small_etc1s_ktx2(false), predicted).find("a P-frame (video)"), std::string::npos);
}

TEST(Ktx2, NamesContradictions) {
  const auto plain = [](const std::function<void(Ktx2File&)>& change) { return problem_after(plain_ktx2(), change); };
  const auto uastc = [](const std::function<void(Ktx2File&)>& change) { return problem_after(uastc_ktx2(), change); };
  const auto etc1s = [](const std::function<void(Ktx2File&)>& change) {
    return problem_after(small_etc1s_ktx2(true), change);
  };
  EXPECT_NE(plain([](Ktx2File& f) { f.faces = 2; }).find("faceCount is 2"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.transfer = 1; }).find("no sRGB transfer function"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.supercompression = 1; }).find("BasisLZ"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.uncompressed_bytes = {15}; }).find("15 bytes, not 16"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.levels[0].resize(15); }).find("cut off"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.supercompression = 2; }).find("Zstandard"), std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) {
              f.levels.resize(3);
              f.uncompressed_bytes.resize(3);
            }).find("2x2 pixels have 3 levels"),
            std::string::npos);
  EXPECT_NE(plain([](Ktx2File& f) { f.width = 0; }).find("0x2"), std::string::npos);
  EXPECT_NE(uastc([](Ktx2File& f) { f.supercompression = 1; }).find("UASTC has BasisLZ"), std::string::npos);
  EXPECT_NE(uastc([](Ktx2File& f) { f.channels = {0, 3}; }).find("UASTC has 2 samples"), std::string::npos);
  EXPECT_NE(uastc([](Ktx2File& f) { f.channels = {9}; }).find("UASTC has channels 9"), std::string::npos);
  EXPECT_NE(etc1s([](Ktx2File& f) { f.supercompression = 0; }).find("no BasisLZ"), std::string::npos);
  EXPECT_NE(etc1s([](Ktx2File& f) { f.channels = {15, 0}; }).find("unknown set of 2 channels"), std::string::npos);
  EXPECT_NE(etc1s([](Ktx2File& f) { f.global_data.resize(30); }).find("global data end early"), std::string::npos);
  EXPECT_NE(etc1s([](Ktx2File& f) { f.global_data[5] = std::byte{99}; }).find("global data end early"),
            std::string::npos);
  EXPECT_NE(etc1s([](Ktx2File& f) { f.global_data[25] = std::byte{9}; }).find("ends beyond its level"),
            std::string::npos);
  EXPECT_NE(problem_after(small_etc1s_ktx2(false),
                          [](Ktx2File& f) {
                            f.channels = {0, 15};
                          })
                .find("no bytes"),
            std::string::npos);
}

TEST(Ktx2, RejectsImpossibleSizes) {
  for (Ktx2File file : all_kinds()) {
    for (const auto& [width, height] : std::vector<std::pair<uint32_t, uint32_t>>{
             {16384, 16384}, {1u << 17, 1u << 11}, {1u << 18, 1}, {0xffffffff, 0xffffffff}}) {
      file.width = width;
      file.height = height;
      const std::string text = problem(file);
      EXPECT_TRUE(text.find("can hold") != std::string::npos || text.find("exceed the limits of") != std::string::npos)
          << text;
    }
  }
}

TEST(Ktx2, RejectsTruncatedFiles) {
  int cases = 0;
  for (const Ktx2File& file : all_kinds()) {
    const std::vector<std::byte> whole = file.bytes();
    for (size_t size = 0; size < whole.size(); ++size, ++cases) {
      const std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_THROW(decode_ktx2(cut, "a.ktx2"), Error) << size << " of " << whole.size();
    }
  }
  EXPECT_GT(cases, 1000);
}

TEST(Ktx2, RandomBytesGiveAnImageOrAnError) {
  std::mt19937 random(1);
  int refused = 0;
  for (const Ktx2File& file : all_kinds()) {
    const std::vector<std::byte> valid = file.bytes();
    for (int i = 0; i < 2000; ++i) {
      std::vector<std::byte> bytes = valid;
      for (uint32_t changes = 1 + static_cast<uint32_t>(random() % 4); changes > 0; --changes)
        bytes[random() % (random() % 2 == 0 ? 104 : bytes.size())] = static_cast<std::byte>(random());
      try {
        const Ktx2Image image = decode_ktx2(bytes, "a.ktx2");
        EXPECT_EQ(image.rgba8.size(), size_t{4} * static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_input);
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Ktx2, IsRecognisedByItsFirstBytes) {
  EXPECT_TRUE(is_ktx2(plain_ktx2().bytes()));
  EXPECT_FALSE(is_ktx2({}));
  EXPECT_NE(problem_of([] {
              decode_ktx2(byte_list({1, 2, 3}), "a.ktx2");
            }).find("the signature of a KTX2 file"),
            std::string::npos);
}

}  // namespace
}  // namespace relume::detail
