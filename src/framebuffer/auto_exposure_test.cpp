#include "framebuffer/auto_exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace relume {
namespace {

constexpr float kBin = 0.125f;  // resolution of the histogram, stops

TEST(AutoExposure, MapsUniformImagesToMiddleGrey) {
  for (const float radiance : {1e-4f, 0.18f, 3.0f, 4000.0f}) {
    const std::vector<Rgb> image(1000, Rgb(radiance));
    EXPECT_NEAR(auto_exposure(image), std::log2(0.18f / radiance), kBin) << radiance;
  }
}

TEST(AutoExposure, AFewBrightOrDarkPixelsChangeLittle) {
  std::vector<Rgb> image(1000, Rgb(0.18f));
  for (size_t i = 0; i < 8; ++i) image[i] = Rgb(1e6f);
  for (size_t i = 10; i < 60; ++i) image[i] = Rgb(1e-6f);
  EXPECT_NEAR(auto_exposure(image), 0.0f, kBin);
}

TEST(AutoExposure, KeepsHighlightsWithinTheCurve) {
  std::vector<Rgb> image(1000, Rgb(1e-3f));
  for (size_t i = 0; i < 30; ++i) image[i] = Rgb(1000);
  EXPECT_NEAR(auto_exposure(image), std::log2(0.18f * 16 / 1000), kBin);
}

TEST(AutoExposure, IgnoresPixelsWithoutAValue) {
  std::vector<Rgb> image(1000, Rgb(0.18f));
  for (size_t i = 0; i < 400; ++i) image[i] = Rgb(i % 2 == 0 ? 0.0f : std::nanf(""));
  EXPECT_NEAR(auto_exposure(image), 0.0f, kBin);
  EXPECT_EQ(auto_exposure(std::vector<Rgb>(10, Rgb(0))), 0.0f);
  EXPECT_EQ(auto_exposure({}), 0.0f);
}

TEST(AutoExposure, SubsamplesLargeImages) {
  std::vector<Rgb> image(1 << 20);
  for (size_t i = 0; i < image.size(); ++i) image[i] = Rgb(i % 2 == 0 ? 0.09f : 0.36f);  // alternating columns
  EXPECT_NEAR(auto_exposure(image), 0.0f, 2 * kBin);
}

TEST(AutoExposure, NeedsOnlyTheMeteredPixels) {
  for (const size_t size :
       {size_t{1}, size_t{65535}, size_t{65536}, size_t{131071}, size_t{131072}, size_t{200001}, size_t{1920} * 1080}) {
    std::vector<Rgb> image(size);
    for (size_t i = 0; i < size; ++i) image[i] = Rgb(0.001f * static_cast<float>(1 + i * 7919 % 1013));
    std::vector<Rgb> metered;
    for (size_t i = 0; i < size; i += metering_stride(size)) metered.push_back(image[i]);
    EXPECT_LT(metered.size(), size_t{1} << 17);
    EXPECT_EQ(auto_exposure(metered), auto_exposure(image)) << size;
  }
}

}  // namespace
}  // namespace relume
