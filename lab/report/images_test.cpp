#include "report/images.h"

#include <cmath>
#include <cstddef>
#include <string_view>

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume {
namespace {

std::vector<std::byte> decode_base64(const std::string& text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::byte> bytes;
  uint32_t bits = 0;
  int count = 0;
  for (char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<uint32_t>(kDigits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> count & 255u));
  }
  return bytes;
}

TEST(Images, HalfPrecision) {
  EXPECT_EQ(half_from_float(0.0f), 0x0000);
  EXPECT_EQ(half_from_float(-0.0f), 0x8000);
  EXPECT_EQ(half_from_float(1.0f), 0x3c00);
  EXPECT_EQ(half_from_float(-2.0f), 0xc000);
  EXPECT_EQ(half_from_float(65504.0f), 0x7bff);  // largest finite number
  EXPECT_EQ(half_from_float(65520.0f), 0x7c00);  // rounds up to infinity
  EXPECT_EQ(half_from_float(1e9f), 0x7c00);
  EXPECT_EQ(half_from_float(0x1p-14f), 0x0400);  // smallest normal number
  EXPECT_EQ(half_from_float(0x1p-24f), 0x0001);  // smallest subnormal number
  EXPECT_EQ(half_from_float(0x1p-26f), 0x0000);
  EXPECT_EQ(half_from_float(1.0f + 0x1p-11f), 0x3c00);  // ties to even
  EXPECT_EQ(half_from_float(1.0f + 0x1.8p-10f), 0x3c02);
  EXPECT_EQ(half_from_float(std::nanf("")) & 0x7fff, 0x7e00);
}

TEST(Images, Base64) {
  // RFC 4648 §10.
  const auto of = [](std::string_view text) { return base64({text.begin(), text.end()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(Images, ValuesRoundTrip) {
  Image image(3, 2);
  image.at(1, 1) = Rgb(0.25f, 100.0f, 3.0f);
  const PageImage page_image = plain_image("a", 0, image, {});
  ASSERT_EQ(page_image.values.size(), 2u);
  std::vector<uint8_t> bytes;
  for (const std::string& plane : page_image.values) {
    const Image decoded = parse_image(decode_base64(plane), "plane");
    ASSERT_EQ(decoded.width, 3);
    // Reading applies the sRGB curve, which is monotonic: compares with the byte's code.
    const float green = decoded.at(1, 1).g;
    Image codes(256, 1);
    std::vector<uint8_t> ramp;
    for (int i = 0; i < 256; ++i) ramp.insert(ramp.end(), 3, static_cast<uint8_t>(i));
    const auto png = encode_png(ramp, 256, 1);
    const Image table = parse_image(std::as_bytes(std::span(png)), "ramp");
    for (int i = 0; i < 256; ++i) {
      if (table.at(i, 0).g == green) bytes.push_back(static_cast<uint8_t>(i));
    }
  }
  ASSERT_EQ(bytes.size(), 2u);
  EXPECT_EQ(bytes[0] << 8 | bytes[1], half_from_float(100.0f));
}

TEST(Images, MapsBelongToTheReference) {
  Image a(16, 16);
  for (Rgb& pixel : a.pixels) pixel = Rgb(0.5f);
  const PageImage page_image = measured_image("a", 0, a, a, {.values = false});
  EXPECT_EQ(page_image.layers.size(), image_layer_kinds().size());
  for (size_t i = 0; i < page_image.layers.size(); ++i)
    EXPECT_EQ(page_image.layers[i].label, image_layer_kinds()[i].label);
  EXPECT_TRUE(page_image.values.empty());
  EXPECT_THROW(measured_image("a", 0, a, Image(3, 3), {}), Error);
}

TEST(Images, CropsShowWhereTheErrorIs) {
  Image reference(140, 70);
  for (Rgb& pixel : reference.pixels) pixel = Rgb(0.5f);
  Image bad = reference;
  for (int y = 30; y < 40; ++y) {
    for (int x = 100; x < 110; ++x) bad.at(x, y) = Rgb(1.0f);
  }
  const auto crops = interesting_crops({&reference, &bad}, reference, 2);
  ASSERT_EQ(crops.size(), 2u);
  EXPECT_EQ(crops[0].x, 100);
  EXPECT_EQ(crops[0].y, 30);
  EXPECT_EQ(crops[0].size, 10);
  EXPECT_TRUE(interesting_crops({&bad}, Image(4, 4), 2).empty());  // no square fits
  const ImageSet set = measured_set("set", reference, {{"bad", 5, &bad, "note"}}, {.values = false});
  ASSERT_EQ(set.images.size(), 2u);
  EXPECT_EQ(set.reference, 0);
  EXPECT_EQ(set.width, 140);
  EXPECT_EQ(set.height, 70);
  EXPECT_EQ(set.images[0].name, "reference");
  EXPECT_EQ(set.images[1].name, "bad");
  EXPECT_EQ(set.images[1].color, 5);
  EXPECT_EQ(set.images[1].note, "note");
  EXPECT_EQ(set.crops.size(), 3u);
  EXPECT_EQ(set.crops[0].x, 100);
}

}  // namespace
}  // namespace relume
