#include "techniques/temporal/accumulate/specular_mean.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

/// One pixel, which continues its own history.
struct Pixel {
  SpecularMean part(const std::vector<Rgb>& specular, const std::vector<Rgb>& albedo) {
    return {.radiance = view_of(specular),
            .albedo = view_of(albedo),
            .history = view_of(mean),
            .history_samples = view_of(samples),
            .mean = mutable_view_of(mean),
            .samples = mutable_view_of(samples)};
  }
  /// A sample of radiance `total`, of which `specular` comes from specular lobes.
  void add(const Rgb& total, const Rgb& specular, const Rgb& albedo = Rgb(0.1f)) {
    const std::vector<Rgb> speculars{specular};
    const std::vector<Rgb> albedos{albedo};
    moments.add(total);
    part(speculars, albedos).add(0, total, keep, moments);
  }

  bool keep = true;
  PixelMoments moments;
  std::vector<Rgb> mean{Rgb(0)};
  std::vector<uint32_t> samples{0};
};

TEST(SpecularMean, KeepsTheMeanWithoutMotion) {
  Pixel pixel;
  PixelMoments expected;
  for (int i = 1; i <= 5; ++i) {
    const Rgb radiance(0.3f * static_cast<float>(i * i));
    expected.add(radiance);
    pixel.add(radiance, radiance * 0.37f);
  }
  EXPECT_EQ(pixel.moments.mean, expected.mean);
  EXPECT_NEAR(pixel.mean[0].r, 0.37f * expected.mean.r, 1e-5f);
}

TEST(SpecularMean, PartsCountTheirOwnSamples) {
  Pixel pixel;
  pixel.moments = {Rgb(3), 0, 0, 7};  // 2 of 3 are specular
  pixel.mean = {Rgb(2)};
  pixel.samples = {1};
  pixel.add(Rgb(10), Rgb(6));
  EXPECT_NEAR(pixel.moments.mean.r, (1 + (4.0f - 1) / 8) + (2 + (6.0f - 2) / 2), 1e-5f);
  EXPECT_NEAR(pixel.mean[0].r, 4, 1e-6f);
}

TEST(SpecularMean, SurfacesWithoutAnImageHaveNone) {
  Pixel pixel;
  pixel.add(Rgb(10), Rgb(6), Rgb(0));
  EXPECT_EQ(pixel.mean[0], Rgb(0));
  EXPECT_EQ(pixel.moments.mean, Rgb(10));
}

TEST(SpecularMean, StartsAgainWithTheMean) {
  Pixel pixel;
  pixel.mean = {Rgb(2)};
  pixel.samples[0] = 7;
  pixel.keep = false;
  pixel.add(Rgb(10), Rgb(6));
  EXPECT_EQ(pixel.samples[0], 1u);
  EXPECT_EQ(pixel.mean[0], Rgb(6));
  EXPECT_EQ(pixel.moments.mean, Rgb(10));
}

TEST(SpecularMean, PixelsWithoutASampleKeepTheirHistory) {
  Pixel pixel;
  const std::vector<Rgb> history{Rgb(5)};
  const std::vector<uint32_t> history_samples{3};
  SpecularMean part = pixel.part(history, history);
  part.history = view_of(history);
  part.history_samples = view_of(history_samples);
  part.keep(0);
  EXPECT_EQ(pixel.mean[0], Rgb(5));
  EXPECT_EQ(pixel.samples[0], 3u);
}

}  // namespace
}  // namespace relume
