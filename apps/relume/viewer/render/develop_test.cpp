// Colours on the processor, compared with the tone map and with the shader's formulas.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/srgb.h"
#include "framebuffer/tone_map.h"
#include "viewer/render/develop.h"
#include "viewer/render/display_table.h"

namespace relume::viewer {
namespace {

std::vector<uint8_t> developed(const std::vector<Rgb>& values, const DisplayTransform& transform) {
  const DisplayTable table = display_table(transform.tone_map);
  std::vector<uint8_t> rgb(3 * values.size());
  develop(values, transform, table, rgb);
  return rgb;
}

TEST(Develop, RadianceFollowsTheToneMap) {
  std::vector<Rgb> values;
  for (int i = 0; i < 4000; ++i) {
    const auto t = static_cast<float>(i);
    values.emplace_back(std::exp2(std::fmod(t * 0.37f, 18.0f) - 11), std::exp2(std::fmod(t * 0.71f, 18.0f) - 11),
                        std::exp2(std::fmod(t * 0.13f, 18.0f) - 11));
  }
  for (const ToneMap curve : {ToneMap::agx, ToneMap::neutral}) {
    const DisplayTransform transform{.tone_map = curve, .exposure = 1.5f};
    const std::vector<uint8_t> rgb = developed(values, transform);
    double sum = 0;
    for (size_t i = 0; i < values.size(); ++i) {
      const Rgb expected = srgb_from_linear(tone_map(curve, transform.exposure, values[i]));
      for (int c = 0; c < 3; ++c)
        sum += std::fabs(static_cast<double>(expected[c]) * 255 - rgb[3 * i + static_cast<size_t>(c)]);
    }
    // The table differs by up to half a step on average, and so does rounding.
    EXPECT_LT(sum / static_cast<double>(3 * values.size()), 1.0);
  }
}

TEST(Develop, BrighterRadianceIsNeverDarker) {
  std::vector<Rgb> values;
  for (int i = 0; i < 2000; ++i) values.emplace_back(std::exp2(-13 + 0.01f * static_cast<float>(i)));
  const std::vector<uint8_t> rgb = developed(values, {.tone_map = ToneMap::agx});
  for (size_t i = 3; i < rgb.size(); ++i) EXPECT_GE(rgb[i], rgb[i - 3]) << i;
}

TEST(Develop, BuffersMapTheirRange) {
  const DisplayTransform color{.mode = DisplayMode::color, .range = {0, 2}};
  EXPECT_EQ(developed({Rgb(0, 2, 5)}, color), (std::vector<uint8_t>{0, 255, 255}));
  const DisplayTransform direction{.mode = DisplayMode::direction};
  EXPECT_EQ(developed({Rgb(-1, 0, 1)}, direction), (std::vector<uint8_t>{0, 128, 255}));
  DisplayTransform depth{.mode = DisplayMode::false_color, .range = {1, 3}, .channel = 0};
  const std::vector<uint8_t> ends = developed({Rgb(1, 9, 9), Rgb(3, 9, 9)}, depth);
  EXPECT_EQ(ends, (std::vector<uint8_t>{0, 0, 0, 255, 255, 255}));
  depth.channel = -1;
  EXPECT_EQ(developed({Rgb(3, 0, 0)}, depth), (std::vector<uint8_t>{255, 255, 255}));
}

TEST(Develop, ValuesThatAreNotFiniteAreMagenta) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const DisplayMode mode :
       {DisplayMode::radiance, DisplayMode::color, DisplayMode::false_color, DisplayMode::direction}) {
    const std::vector<uint8_t> rgb = developed({Rgb(nan, 0, 0), Rgb(0, infinity, 0)}, {.mode = mode});
    EXPECT_EQ(rgb, (std::vector<uint8_t>{255, 0, 255, 255, 0, 255}));
  }
}

}  // namespace
}  // namespace relume::viewer
