#include "experiments/measure/estimate.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "experiments/experiment.h"
#include "testing/random.h"

namespace relume {
namespace {

/// Nearly normal, of variance 1.
float noise(uint32_t seed, uint32_t i) {
  float sum = -6;
  for (uint32_t k = 0; k < 12; ++k) sum += to_unit_float(hash(seed, i, k));
  return sum;
}

std::vector<Image> repetitions(int count, float bias, float spread, uint32_t seed) {
  std::vector<Image> list;
  for (int r = 0; r < count; ++r) {
    Image image(16, 16);
    uint32_t i = 0;
    for (Rgb& p : image.pixels) {
      for (int c = 0; c < 3; ++c) p[c] = 1 + bias + spread * noise(seed + static_cast<uint32_t>(r), i++);
    }
    list.push_back(std::move(image));
  }
  return list;
}

Image reference() {
  Image image(16, 16);
  for (Rgb& p : image.pixels) p = Rgb(1);
  return image;
}

TEST(Estimate, TheMeansErrorIsTheUsualOne) {
  const Estimate e = mean_estimate({1, 2, 3, 6});
  EXPECT_EQ(e.value, 3);
  EXPECT_NEAR(e.error(), std::sqrt(14.0 / 3 / 4), 1e-12);  // standard deviation over the root of n
}

TEST(Estimate, SquaredBiasWithoutNoiseIsExact) {
  const Estimate e = squared_bias(repetitions(3, 0.5f, 0, 1), reference(), 0.01);
  EXPECT_NEAR(e.value, 0.24, 1e-7);
  EXPECT_NEAR(e.error(), 0, 1e-9);
  EXPECT_THROW(squared_bias(repetitions(2, 0.5f, 0, 1), reference(), 0), Error);
}

/// Of many estimates, how far they say that they stray over how far they do.
double stated_over_true(float bias, float spread) {
  double mean = 0;
  double square = 0;
  double stated = 0;
  constexpr int kTrials = 200;
  for (uint32_t t = 0; t < kTrials; ++t) {
    const Estimate e = squared_bias(repetitions(6, bias, spread, 1000 * t), reference(), 0);
    mean += e.value / kTrials;
    square += e.value * e.value / kTrials;
    stated += e.error() * e.error() / kTrials;
  }
  const double strayed = std::sqrt(square - mean * mean);
  EXPECT_NEAR(mean, double{bias} * double{bias}, 4 * strayed / std::sqrt(kTrials));
  return std::sqrt(stated) / strayed;
}

TEST(Estimate, ItsErrorIsThatOfTheNoise) {
  EXPECT_NEAR(stated_over_true(1, 0.3f), 1, 0.25);  // 200 trials know the spread to 5 %
  // Where noise outweighs the bias, the jackknife of products says 2.5 times the variance for six repetitions.
  EXPECT_NEAR(stated_over_true(0.1f, 1), std::sqrt(2.5), 0.25);
}

TEST(Estimate, NoiseDecidesNothing) {
  const Image truth = reference();
  const auto compared = [&](float a, float b, float spread) {
    const Estimate first = squared_bias(repetitions(6, a, spread, 100), truth, 0);
    const Estimate second = squared_bias(repetitions(6, b, spread, 900), truth, 0);
    return std::string(verdict_below(difference(first, second)));
  };
  EXPECT_EQ(compared(0.1f, 0.5f, 0.1f), kVerdictHolds);
  EXPECT_EQ(compared(0.5f, 0.1f, 0.1f), kVerdictFails);
  EXPECT_EQ(compared(0.1f, 0.1f, 3), kVerdictUndecided);
  EXPECT_EQ(compared(0.1f, 0.11f, 3), kVerdictUndecided);  // with less noise it would hold
  EXPECT_EQ(compared(0.1f, 0.11f, 0.01f), kVerdictHolds);
}

TEST(Estimate, AMarginDecidesWhatIsEqual) {
  const Image truth = reference();
  const Estimate a = squared_bias(repetitions(6, 0.5f, 0.001f, 100), truth, 0);
  const Estimate b = squared_bias(repetitions(6, 0.5f, 0.001f, 900), truth, 0);
  EXPECT_EQ(scaled(b, 2).error(), 2 * b.error());
  EXPECT_STREQ(verdict_below(difference(a, scaled(b, 1.05))), kVerdictHolds);
  EXPECT_STREQ(verdict_below(difference(a, scaled(b, 0.95))), kVerdictFails);
}

TEST(Estimate, OneClaimThatFailsDecides) {
  EXPECT_STREQ(verdict_of_all({kVerdictHolds, kVerdictUndecided, kVerdictFails}), kVerdictFails);
  EXPECT_STREQ(verdict_of_all({kVerdictHolds, kVerdictUndecided}), kVerdictUndecided);
  EXPECT_STREQ(verdict_of_all({kVerdictHolds, kVerdictHolds}), kVerdictHolds);
}

}  // namespace
}  // namespace relume
