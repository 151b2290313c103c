#include "metrics/statistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(Statistics, MedianIsTheMiddle) {
  EXPECT_EQ(median({}), 0);
  EXPECT_EQ(median({3}), 3);
  EXPECT_EQ(median({9, 1, 5}), 5);
  EXPECT_EQ(median({9, 1, 5, 6}), 5.5);
}

TEST(Statistics, MedianIntervalCountsOrderStatistics) {
  // Five values: P(the median lies within the range) = 1 - 2 / 2^5.
  const Interval five = median_interval({5, 1, 4, 2, 3});
  EXPECT_EQ(five.low, 1);
  EXPECT_EQ(five.high, 5);
  EXPECT_DOUBLE_EQ(five.confidence, 0.9375);
  // Nine: second and eighth, 1 - 2 (1 + 9) / 2^9 (tables of the sign test).
  const Interval nine = median_interval({1, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_EQ(nine.low, 2);
  EXPECT_EQ(nine.high, 8);
  EXPECT_DOUBLE_EQ(nine.confidence, 1 - 20.0 / 512);
  EXPECT_EQ(median_interval({7}).confidence, 0);
  // Many: the normal approximation, n / 2 ± 0.98 √n.
  std::vector<double> many;
  for (int i = 1; i <= 2000; ++i) many.push_back(i);
  const Interval wide = median_interval(many);
  EXPECT_NEAR(wide.low, 1000 - 0.98 * std::sqrt(2000.0), 2);
  EXPECT_EQ(wide.low + wide.high, 2001);
  EXPECT_NEAR(wide.confidence, 0.95, 0.005);
}

TEST(Statistics, MeanIntervalIsStudents) {
  // s = 1, n = 3, t(2) = 4.303.
  const Interval three = mean_interval({1, 2, 3});
  EXPECT_NEAR(three.high - 2, 4.303 / std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(2 - three.low, 4.303 / std::sqrt(3.0), 1e-9);
  // t(20) = 2.086 (tables).
  std::vector<double> values;
  for (int i = 0; i < 21; ++i) values.push_back(i);
  const double expected = 2.086 * standard_deviation(values) / std::sqrt(21.0);
  EXPECT_NEAR(mean_interval(values).high - 10, expected, 2e-3 * expected);
}

TEST(Statistics, StandardDeviationIsUnbiased) {
  EXPECT_EQ(standard_deviation({4}), 0);
  EXPECT_DOUBLE_EQ(standard_deviation({1, 3}), std::sqrt(2.0));
}

}  // namespace
}  // namespace relume
