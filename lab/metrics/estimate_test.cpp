#include "metrics/estimate.h"

#include <cmath>

#include <gtest/gtest.h>

#include "metrics/testing/noisy_images.h"
#include "relume/error.h"

namespace relume {
namespace {

using testing::reference;
using testing::repetitions;

TEST(Estimate, TheMeansErrorIsTheUsualOne) {
  const Estimate e = mean_estimate({1, 2, 3, 6});
  EXPECT_EQ(e.value, 3);
  EXPECT_NEAR(e.error(), std::sqrt(14.0 / 3 / 4), 1e-12);  // standard deviation over the root of n
  EXPECT_NEAR(e.half_width(), 3.182 * e.error(), 1e-9);    // t(3)
  EXPECT_EQ(mean_estimate({7}).half_width(), 0);
  EXPECT_EQ(scaled(e, 2).value, 6);
  EXPECT_EQ(scaled(e, 2).error(), 2 * e.error());
  EXPECT_EQ(difference(scaled(e, 2), e).value, 3);
  EXPECT_THROW(difference(e, mean_estimate({1, 2})), Error);
}

TEST(Estimate, SquaredBiasWithoutNoiseIsExact) {
  const Estimate e = squared_bias(repetitions(3, 0.5f, 0, 1), reference(), 0.01);
  EXPECT_NEAR(e.value, 0.24, 1e-7);
  EXPECT_NEAR(e.error(), 0, 1e-9);
  EXPECT_THROW(squared_bias(repetitions(2, 0.5f, 0, 1), reference(), 0), Error);
}

TEST(Estimate, SquaredBiasExcludesNonFinitePixels) {
  std::vector<Image> images = repetitions(3, 0.5f, 0, 1);
  images[1].at(3, 4).g = std::nanf("");
  Image truth = reference();
  truth.at(5, 6).r = kInfinity;
  EXPECT_NEAR(squared_bias(images, truth, 0).value, 0.25, 1e-7);
  for (Rgb& p : truth.pixels) p.b = std::nanf("");
  EXPECT_THROW(squared_bias(images, truth, 0), Error);
}

/// Ratio of the stated to the actual error over many estimates.
double stated_over_true(float bias, float spread, int count) {
  double mean = 0;
  double square = 0;
  double stated = 0;
  constexpr int kTrials = 200;
  for (uint32_t t = 0; t < kTrials; ++t) {
    const Estimate e = squared_bias(repetitions(count, bias, spread, 1000 * t), reference(), 0);
    mean += e.value / kTrials;
    square += e.value * e.value / kTrials;
    stated += e.error() * e.error() / kTrials;
  }
  const double strayed = std::sqrt(square - mean * mean);
  EXPECT_NEAR(mean, double{bias} * double{bias}, 4 * strayed / std::sqrt(kTrials));
  return std::sqrt(stated) / strayed;
}

TEST(Estimate, ErrorMatchesTheNoise) {
  EXPECT_NEAR(stated_over_true(1, 0.3f, 6), 1, 0.25);  // 200 trials determine the spread to 5 %
  // If noise outweighs the bias, the jackknife of products overestimates the variance 2.5 times for six repetitions and
  // four times for three.
  EXPECT_NEAR(stated_over_true(0.1f, 1, 6), std::sqrt(2.5), 0.25);
  EXPECT_NEAR(stated_over_true(0.1f, 1, 3), 2, 0.4);
}

}  // namespace
}  // namespace relume
