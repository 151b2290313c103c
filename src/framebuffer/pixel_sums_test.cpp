#include "framebuffer/pixel_sums.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "testing/random.h"

namespace relume {
namespace {

std::vector<Rgb> samples_of(uint32_t count, uint32_t seed) {
  testing::Random random(seed);
  std::vector<Rgb> samples;
  for (uint32_t i = 0; i < count; ++i) {
    const float r = random.next();
    samples.emplace_back(r, 10.0f * random.next(), r * 1e-3f);
  }
  return samples;
}

/// The sums of samples [first, end).
RadianceSums sums_of(const std::vector<Rgb>& samples, uint32_t first, uint32_t end) {
  RadianceSums sums;
  SampleBlock block;
  for (uint32_t i = first; i < end; ++i) {
    block.add(samples[i]);
    if (i % kBlockSamples + 1 != kBlockSamples && i + 1 != end) continue;
    sums.add(block);
    block = {};
  }
  return sums;
}

void expect_equal(const RadianceSums& a, const RadianceSums& b) {
  EXPECT_EQ(a.r, b.r);
  EXPECT_EQ(a.g, b.g);
  EXPECT_EQ(a.b, b.b);
  EXPECT_EQ(a.square, b.square);
}

TEST(PixelSums, GiveTheMeanAndTheVarianceOfTheMean) {
  const std::vector<Rgb> samples = samples_of(100, 3);
  PixelMoments moments;
  for (const Rgb& sample : samples) moments.add(sample);
  const RadianceSums sums = sums_of(samples, 0, 100);
  const Rgb mean = sums.mean(100);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], moments.mean[c], 1e-6f * moments.mean[c] + 1e-9f);
  const float variance = variance_of_mean(moments.m2, 100);
  EXPECT_NEAR(sums.variance(100, 1), variance, 1e-5f * variance);
  EXPECT_NEAR(sums.variance(100, 8), variance_of_mean(moments.m2, 100, 8), 1e-4f * variance);
}

TEST(PixelSums, EqualThoseOfTheirPartsInAnyOrder) {
  const std::vector<Rgb> samples = samples_of(100, 4);
  const RadianceSums whole = sums_of(samples, 0, 100);
  RadianceSums parts = sums_of(samples, 64, 100);
  parts.add(sums_of(samples, 0, 16));
  parts.add(sums_of(samples, 16, 64));
  expect_equal(parts, whole);
}

TEST(PixelSums, HaveNoVarianceForConstantSamples) {
  for (const float value : {0.1f, 1e-4f, 12345.678f, 3e9f}) {
    const std::vector<Rgb> samples(1000, Rgb(value, 0.3f * value, 0.7f * value));
    EXPECT_EQ(sums_of(samples, 0, 1000).variance(1000, 1), 0.0f) << value;
    EXPECT_EQ(sums_of(samples, 0, 1000).mean(1000).r, value);
  }
}

TEST(PixelSums, KeepASmallVarianceOfBrightSamples) {
  std::vector<Rgb> samples(64, Rgb(1000));
  for (size_t i = 0; i < samples.size(); i += 2) samples[i] = Rgb(1000.125f);
  const double expected = 0.0625 * 0.0625 / 63;
  EXPECT_NEAR(sums_of(samples, 0, 64).variance(64, 1), expected, 1e-3 * expected);
}

TEST(PixelSums, LimitSquaresWithTheirValues) {
  std::vector<Rgb> samples(32, Rgb(0));
  samples[3] = Rgb(std::numeric_limits<float>::max());
  const RadianceSums sums = sums_of(samples, 0, 32);
  EXPECT_EQ(sums.mean(32), Rgb(0x1p39f));
  // One sample of 2^44: Σ Y² = 2^88, (Σ Y)² / n = 2^83.
  const double expected = 0x1p88 * (1 - 1.0 / 32) / (32.0 * 31.0);
  EXPECT_NEAR(sums.variance(32, 1), expected, 1e-6 * expected);
}

TEST(PixelSums, OfNoSamplesAreBlack) {
  EXPECT_EQ(RadianceSums().mean(0), Rgb(0));
  EXPECT_EQ(RadianceSums().variance(1, 1), 0.0f);
  EXPECT_EQ(mean_of(FixedSum<1, 38>(), 0), 0.0f);
}

TEST(PixelSums, OfSurfacesIgnoreWhatIsNotFinite) {
  SurfaceSums sums;
  sums.add(Rgb(0.25f), Vec3(0, -1, 0), 3);
  sums.add(Rgb(std::numeric_limits<float>::quiet_NaN()), Vec3(0, 1, 0.5f), kInfinity);
  EXPECT_EQ(mean_of(sums.albedo[0], 2), 0.125f);
  EXPECT_EQ(mean_of(sums.normal[1], 2), 0.0f);
  EXPECT_EQ(mean_of(sums.normal[2], 2), 0.25f);
  EXPECT_EQ(mean_of(sums.depth, 2), 1.5f);
}

}  // namespace
}  // namespace relume
