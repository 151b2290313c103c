#include "techniques/temporal/adaptive_sampling/pooled_deviation.h"

#include <gtest/gtest.h>

#include <vector>

#include "framebuffer/testing/moment_vectors.h"

namespace relume {
namespace {

/// Pixels with four samples of standard deviation 1, and their pools.
struct Pool {
  Pool(uint32_t w, uint32_t h)
      : width(w), height(h), history(w * h, {Rgb(0.5f), 3, 9, 4}), moments(w * h), rows(w * h), deviation(w * h) {}

  const std::vector<float>& estimate(bool display = false, float exposure = 1) {
    each_pixel(OwnStatisticsKernel{history.view(), mutable_view_of(moments), width});
    each_pixel(PoolRowsKernel{view_of(moments), mutable_view_of(rows), width});
    each_pixel(PooledDeviationKernel{view_of(moments), view_of(rows), mutable_view_of(deviation), width, height,
                                     display, exposure});
    return deviation;
  }
  template <typename Kernel>
  void each_pixel(const Kernel& kernel) const {
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) kernel(x, y);
  }

  uint32_t width;
  uint32_t height;
  testing::MomentVectors history;
  std::vector<PooledMoments> moments;
  std::vector<PooledMoments> rows;
  std::vector<float> deviation;
};

TEST(PooledDeviation, IsPerSample) {
  Pool pool(9, 9);
  for (const float d : pool.estimate()) EXPECT_FLOAT_EQ(d, 1.0f);
}

TEST(PooledDeviation, ExcludesThePixelItself) {
  Pool pool(9, 9);
  const std::vector<float> before = pool.estimate();
  const uint32_t own = 4 * 9 + 4;
  pool.history.m2_rgb[own] = 9e6f;
  pool.history.samples[own] = 400;
  pool.history.mean[own] = Rgb(1e4f);
  const std::vector<float> after = pool.estimate();
  EXPECT_EQ(after[own], before[own]) << "its own samples decide how many it gets";
  EXPECT_GT(after[own + 1], before[own + 1]);
  EXPECT_EQ(after[own + 3], before[own + 3]) << "beyond the pool";
}

TEST(PooledDeviation, WeighsPixelsByTheirSamples) {
  // Three pixels: the neighbours have 2 and 5 samples, with sums of squares of 8 and 2 per channel.
  Pool pool(3, 1);
  pool.history.samples = {2, 0, 5};
  pool.history.m2_rgb = {24, 0, 6};
  EXPECT_FLOAT_EQ(pool.estimate()[1], std::sqrt(10.0f / 5.0f));
  pool.history.samples = {1, 0, 0};
  EXPECT_EQ(pool.estimate()[1], 0.0f);
}

TEST(PooledDeviation, ChannelsCountEqually) {
  // Blue noise of standard deviation √3 has a luminance of little noise, but the mean squared error of grey noise.
  Pool pool(9, 9);
  pool.history.m2.assign(81, 0.0156f);
  for (const float d : pool.estimate()) EXPECT_FLOAT_EQ(d, 1.0f);
}

TEST(PooledDeviation, CanUseDisplayValues) {
  Pool pool(5, 5);
  const float at_half = pool.estimate(true)[12];
  // The derivative of 1.055 L^(1/2.4) − 0.055 at L = 0.5.
  EXPECT_NEAR(at_half, 1.055 / 2.4 * std::pow(0.5, 1 / 2.4 - 1), 1e-5);
  pool.history.mean.assign(25, Rgb(0.05f));
  EXPECT_GT(pool.estimate(true)[12], 3.0f * at_half) << "dark places count more";
  EXPECT_NEAR(pool.estimate(true, 10)[12], 10 * at_half, 1e-3f) << "ten times as bright on the display";
  EXPECT_EQ(pool.estimate(true, 30)[12], 0.0f) << "above white";
}

TEST(PooledAllocation, RatesFollowTheDeviationWithinBounds) {
  const SampleRate rate{0.25f, 0.05f};
  EXPECT_FLOAT_EQ(rate(1.0f), 0.25f);
  EXPECT_FLOAT_EQ(rate(2.0f), 0.5f);
  EXPECT_FLOAT_EQ(rate(100.0f), 1.0f);
  EXPECT_FLOAT_EQ(rate(0.0f), 0.05f);
}

struct Allocation {
  explicit Allocation(float deviation, uint32_t kept)
      : noise(kPixels, deviation), samples(kPixels, kept), probability(kPixels), allocation(kPixels) {}

  /// Samples of each pixel over `frames` frames.
  std::vector<uint32_t> run(uint32_t frames, bool settled = false) {
    std::vector<uint32_t> sum(kPixels);
    for (uint32_t frame = 0; frame < frames; ++frame) {
      const PooledAllocationKernel kernel{.deviation = view_of(noise),
                                          .samples = view_of(samples),
                                          .probability = mutable_view_of(probability),
                                          .allocation = mutable_view_of(allocation),
                                          .rate = {0.25f, 0.05f},
                                          .settled = settled,
                                          .seed = 3,
                                          .frame = frame,
                                          .width = kPixels};
      for (uint32_t x = 0; x < kPixels; ++x) {
        kernel(x, 0);
        sum[x] += allocation[x];
      }
    }
    return sum;
  }

  static constexpr uint32_t kPixels = 2000;
  std::vector<float> noise;
  std::vector<uint32_t> samples;
  std::vector<float> probability;
  std::vector<uint32_t> allocation;
};

TEST(PooledAllocation, SamplesOfAPixelSpreadEvenlyOverFrames) {
  Allocation a(1.0f, 8);  // one frame in four
  for (const uint32_t n : a.run(40)) {
    EXPECT_GE(n, 8u);
    EXPECT_LE(n, 12u);
  }
}

TEST(PooledAllocation, EveryPixelGetsTheMinimumFirst) {
  Allocation a(0.0f, 3);
  for (const uint32_t n : a.run(1)) EXPECT_EQ(n, 1u);
}

TEST(PooledAllocation, SettledProbabilitiesDoNotFollowTheNoise) {
  Allocation a(100.0f, 8);
  a.probability.assign(Allocation::kPixels, 0.5f);
  a.run(1, true);
  for (const float p : a.probability) EXPECT_EQ(p, 0.5f);
}

}  // namespace
}  // namespace relume
