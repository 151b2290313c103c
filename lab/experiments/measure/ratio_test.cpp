#include "experiments/measure/ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace relume {
namespace {

TEST(Ratio, HasStudentsIntervals) {
  // Relative standard errors of 0.5 % and 4 %: Welch's degrees of freedom slightly exceed those of the second.
  const std::vector<double> a{101, 99, 101, 99};
  const std::vector<double> b{21, 19, 22, 18};
  const double sigma_a = std::sqrt(4.0 / 3 / 4) / 100;
  const double sigma_b = std::sqrt(10.0 / 3 / 4) / 20;
  const Ratio ratio = error_ratio(a, b);
  EXPECT_DOUBLE_EQ(ratio.value, 5);
  const double spread = std::exp(3.182 * std::sqrt(sigma_a * sigma_a + sigma_b * sigma_b));
  EXPECT_NEAR(ratio.interval.low, 5 / spread, 1e-9);
  EXPECT_NEAR(ratio.interval.high, 5 * spread, 1e-9);
  EXPECT_EQ(error_ratio({3}, {1}).interval.confidence, 0);
  // Error too small to measure: below the bounds, and not a failure.
  const Ratio unseen = error_ratio({-1e-4, 1e-4, -1e-4}, {1, 1.1, 0.9});
  EXPECT_EQ(unseen.value, 0);
  EXPECT_GT(unseen.interval.high, 1e-4);
  EXPECT_STREQ(verdict_of(unseen.interval, 0, 0.5), kVerdictHolds);
  EXPECT_STREQ(verdict_of(unseen.interval, 0.5), kVerdictFails);
  EXPECT_STREQ(verdict_of(error_ratio({-1e-4}, {1}).interval, 0, 0.5), kVerdictUndecided);
  EXPECT_EQ(to_text(error_ratio({-1e-4}, {1})), "0× (at least 0)");
  // Below the reference's noise, no comparison is possible.
  const Ratio unknown = error_ratio({1e-4, 1e-4}, {-1e-7, -2e-7});
  EXPECT_STREQ(verdict_of(unknown.interval, 5), kVerdictUndecided);
}

TEST(Ratio, PairsCancelCommonNoise) {
  const std::vector<double> b{1, 5, 2, 9, 3};
  std::vector<double> a;
  for (const double x : b) a.push_back(2 * x);
  const Ratio same = paired_error_ratio(a, b);
  EXPECT_DOUBLE_EQ(same.value, 2);
  EXPECT_NEAR(same.interval.low, 2, 1e-9);
  EXPECT_NEAR(same.interval.high, 2, 1e-9);
  EXPECT_LT(error_ratio(a, b).interval.low, 1);
  // Deviations of the quotient of ±10 %: a standard error of 0.1 · 2/√3 / 2.
  const Ratio apart = paired_error_ratio({0.9, 1.1, 0.9, 1.1}, {1, 1, 1, 1});
  EXPECT_NEAR(apart.interval.high, std::exp(3.182 * 0.1 / std::sqrt(3.0)), 1e-4);
  EXPECT_EQ(paired_error_ratio({-1, 1e-4}, {1, 1}).value, 0);
  EXPECT_EQ(paired_error_ratio({3}, {1}).interval.confidence, 0);
}

/// Tests intervals of many noisy pairs that share half of their noise.
TEST(Ratio, IntervalsOfPairsHaveTheirStatedCoverage) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.15);
  constexpr int kTrials = 4000;
  int held = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> a;
    std::vector<double> b;
    for (int i = 0; i < 5; ++i) {
      const double both = noise(random);
      a.push_back(3 * (1 + both + noise(random)));
      b.push_back(1 + both + noise(random));
    }
    const Interval interval = paired_error_ratio(a, b).interval;
    held += interval.low <= 3 && 3 <= interval.high;
  }
  EXPECT_NEAR(held / static_cast<double>(kTrials), 0.95, 0.015);
}

TEST(Ratio, CommonSlowdownsCancel) {
  const std::vector<double> b{1, 1, 4, 1, 1, 2, 1, 1, 3, 1};
  std::vector<double> a;
  for (const double x : b) a.push_back(1.1 * x);
  a.back() = 9;
  const Ratio ratio = time_ratio(a, b);
  EXPECT_NEAR(ratio.value, 1.1, 1e-9);
  EXPECT_NEAR(ratio.interval.low, 1.1, 1e-9);
  EXPECT_NEAR(ratio.interval.high, 1.1, 1e-9);
  EXPECT_GE(ratio.interval.confidence, 0.95);
}

TEST(Ratio, VerdictsFollowIntervals) {
  const auto verdict = [](const std::vector<Ratio>& ratios) {
    return judged_ratios("a", "[X §1]", "c", "m", ratios, 5).verdict;
  };
  const Ratio above{7, {5.1, 9, 0.95}};
  const Ratio around{7, {4.9, 9, 0.95}};
  const Ratio below{3, {2, 4.9, 0.95}};
  EXPECT_EQ(verdict({above}), kVerdictHolds);
  EXPECT_EQ(verdict({above, around}), kVerdictUndecided);
  EXPECT_EQ(verdict({above, around, below}), kVerdictFails);
  EXPECT_STREQ(verdict_of({1.5, 2.5, 0.95}, 1, 2), kVerdictUndecided);
  EXPECT_STREQ(verdict_of({2.1, 2.5, 0.95}, 1, 2), kVerdictFails);
}

TEST(Ratio, QuotientsOfRepetitionsHaveAGeometricMean) {
  const Ratio ratio = geometric_mean({0.5, 1, 2});
  EXPECT_NEAR(ratio.value, 1, 1e-12);
  const double spread = std::exp(4.303 * std::log(2.0) / std::sqrt(3.0));
  EXPECT_NEAR(ratio.interval.high, spread, 1e-3 * spread);
  EXPECT_EQ(geometric_mean({0.5}).interval.low, 0.5);
  EXPECT_EQ(geometric_mean({0.5}).interval.confidence, 0);
}

TEST(Ratio, ProductsAddTheSquaresOfSpreadsInLogarithms) {
  const Ratio a{2, {1, 4, 0.95}};
  const Ratio b{3, {3, 3, 0.9}};
  EXPECT_DOUBLE_EQ(product(a, b).value, 6);
  EXPECT_NEAR(product(a, b).interval.low, 3, 1e-9);
  EXPECT_EQ(product(a, b).interval.confidence, 0.9);
  const Ratio q = quotient(b, a);
  EXPECT_DOUBLE_EQ(q.value, 1.5);
  EXPECT_NEAR(q.interval.low, 0.75, 1e-9);
  EXPECT_NEAR(q.interval.high, 3, 1e-9);
  EXPECT_STREQ(verdict_of(product({0, {0, 0, 0.95}}, a).interval, 1), kVerdictUndecided);
}

TEST(Ratio, RangesAreJudgedByIntervals) {
  const auto verdict = [](const Ratio& r) { return judged_within("a", "[X]", "c", "m", "t", {r}, 0.5, 2).verdict; };
  EXPECT_EQ(verdict({1, {0.6, 1.9, 0.95}}), kVerdictHolds);
  EXPECT_EQ(verdict({1, {0.4, 1.9, 0.95}}), kVerdictUndecided);
  EXPECT_EQ(verdict({3, {2.1, 4, 0.95}}), kVerdictFails);
}

}  // namespace
}  // namespace relume
