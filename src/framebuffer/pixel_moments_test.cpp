#include "framebuffer/pixel_moments.h"

#include <gtest/gtest.h>

#include "framebuffer/testing/moment_vectors.h"
#include "testing/random.h"

namespace relume {
namespace {

float variance_of(const PixelMoments& moments) { return variance_of_mean(moments.m2, moments.samples); }

TEST(PixelMoments, VarianceOfTheMeanMatchesItsDefinition) {
  // Grey values 1, 2, 3, 6: mean 3, unbiased variance 14/3, variance of the mean 14/12.
  PixelMoments moments;
  for (const float v : {1.0f, 2.0f, 3.0f, 6.0f}) moments.add(Rgb(v));
  EXPECT_EQ(moments.mean, Rgb(3));
  EXPECT_NEAR(variance_of(moments), 14.0 / 12.0, 1e-5);
}

TEST(PixelMoments, SumsTheSquaresOfAllChannels) {
  // Channels 0 and 2, 0 and 4, 1 and 1: deviations of 1, 2 and 0 from their means, each twice.
  PixelMoments moments;
  moments.add(Rgb(0, 0, 1));
  moments.add(Rgb(2, 4, 1));
  EXPECT_FLOAT_EQ(moments.m2_rgb, 2 * (1 + 4 + 0));
}

TEST(PixelMoments, VarianceIsUnbiased) {
  // Averages the estimate from 8 uniform numbers over many pixels; expects 1/12/8.
  testing::Random random(81);
  double mean = 0;
  constexpr int kPixels = 20000;
  for (int i = 0; i < kPixels; ++i) {
    PixelMoments moments;
    for (int k = 0; k < 8; ++k) moments.add(Rgb(random.next()));
    mean += static_cast<double>(variance_of(moments)) / kPixels;
  }
  EXPECT_NEAR(mean * 96.0, 1.0, 0.02);  // estimates spread by 0.45 of their mean: five standard errors are 0.016
}

TEST(PixelMoments, ManySamplesLoseNothing) {
  // 2^16 values that alternate between 0.1 and 0.3: mean 0.2, variance 0.01.
  PixelMoments moments;
  constexpr uint32_t kCount = 1u << 16;
  for (uint32_t i = 0; i < kCount; ++i) moments.add(Rgb(i % 2 ? 0.3f : 0.1f));
  EXPECT_NEAR(moments.mean.x, 0.2f, 1e-4f);
  EXPECT_NEAR(variance_of(moments) * kCount, 0.01f, 1e-4f);
}

TEST(PixelMoments, VarianceNeedsTwoSamples) {
  EXPECT_EQ(variance_of_mean(1.0f, 1), 0.0f);
  EXPECT_EQ(variance_of_mean(0.0f, 0), 0.0f);
}

TEST(PixelMoments, CorrelationsRaiseTheVariance) {
  EXPECT_EQ(variance_of_mean(12.0f, 4, 1), variance_of_mean(12.0f, 4));
  // ρ = 1/2: T = 1 + 2 (3/4 · 1/2 + 2/4 · 1/4 + 1/4 · 1/8) = 2.0625, and the factor is 3 T / (4 − T).
  EXPECT_FLOAT_EQ(variance_of_mean(12.0f, 4, 3), 3 * 2.0625f / 1.9375f * variance_of_mean(12.0f, 4));
  // Two samples: T = 1 + ρ.
  for (const uint32_t correlated : {3u, 41u, 2001u})
    EXPECT_NEAR(correlation_factor(2, correlated), correlated, 1e-6 * correlated);
  EXPECT_NEAR(correlation_factor(1'000'000, 41), 41, 0.01);
  EXPECT_EQ(correlation_factor(1, 41), 1);
  EXPECT_EQ(correlation_factor(0, 41), 1);
  for (uint32_t n = 2; n < 4000; ++n) {
    EXPECT_GE(correlation_factor(n, 41), 41 - 1e-6);
    EXPECT_LE(correlation_factor(n, 41), 1.34 * 41);
  }
}

TEST(PixelMoments, VarianceOfCorrelatedSamplesIsUnbiased) {
  // Moving averages of uniform numbers with ρ = 2/3: a sample has the variance 1/12 · (1 − ρ) / (1 + ρ) = 1/60, and the
  // mean of twelve T / 12 of it, T = 5 − (1 − ρ^12) = 4.0077.
  testing::Random random(82);
  double mean = 0;
  constexpr int kPixels = 20000;
  for (int i = 0; i < kPixels; ++i) {
    PixelMoments moments;
    float average = 0.5f;
    for (int k = 0; k < 42; ++k) {
      average = (2 * average + random.next()) / 3;
      if (k >= 30) moments.add(Rgb(average));
    }
    mean += static_cast<double>(variance_of_mean(moments.m2, moments.samples, 5)) / kPixels;
  }
  // Estimates spread by 0.52 of their mean: five standard errors are 0.018.
  EXPECT_NEAR(mean * 60 * 12 / 4.0077, 1.0, 0.02);
}

TEST(PixelMoments, LimitKeepsTheMeanAndTheVarianceOfASample) {
  PixelMoments many{Rgb(3), 200, 600, 101};
  many.limit(11);
  EXPECT_EQ(many.samples, 11u);
  EXPECT_EQ(many.mean, Rgb(3));
  EXPECT_FLOAT_EQ(many.m2 / 10.0f, 200.0f / 100.0f);
  EXPECT_FLOAT_EQ(many.m2_rgb / 10.0f, 600.0f / 100.0f);
  PixelMoments few{Rgb(3), 5, 15, 3};
  few.limit(11);
  EXPECT_EQ(few.samples, 3u);
  EXPECT_EQ(few.m2, 5.0f);
  few.limit(0);
  EXPECT_EQ(few.samples, 0u);
  EXPECT_EQ(few.m2, 0.0f);
}

TEST(PixelMoments, PlanesReturnStoredMoments) {
  testing::MomentVectors planes(2);
  planes.mutable_view().store(1, {Rgb(1, 2, 3), 4, 5, 6});
  const PixelMoments read = planes.view()[1];
  EXPECT_EQ(read.mean, Rgb(1, 2, 3));
  EXPECT_EQ(read.m2, 4.0f);
  EXPECT_EQ(read.m2_rgb, 5.0f);
  EXPECT_EQ(read.samples, 6u);
  MutableMomentsView without = planes.mutable_view();
  without.m2_rgb = {};
  without.store(0, {Rgb(1), 2, 3, 4});
  EXPECT_EQ(MomentsView(without)[0].m2_rgb, 0.0f) << "the plane does not exist";
  EXPECT_EQ(planes.m2_rgb[0], 0.0f);
}

}  // namespace
}  // namespace relume
