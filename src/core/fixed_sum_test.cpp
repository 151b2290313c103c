#include "core/fixed_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "testing/random.h"

namespace relume {
namespace {

using Sum = FixedSum<2, 60>;

Sum sum_of(const std::vector<double>& values) {
  Sum sum;
  for (const double value : values) sum.add(value);
  return sum;
}

TEST(FixedSum, HoldsRepresentableValuesExactly) {
  for (const double value : {0.0, 1.0, -1.0, 0.1, -0.1, 1e-5, 3e12, -7e11, 0x1p-60, -0x1p-60, 0x1p44, 0x1p4, 0x1p3}) {
    Sum sum;
    sum.add(value);
    EXPECT_EQ(sum.value(), std::nearbyint(value * 0x1p60) * 0x1p-60) << value;
  }
}

TEST(FixedSum, RoundsToTheNearestUnit) {
  for (const auto& [value, units] :
       {std::pair(0.49, 0.0), {0.5, 1.0}, {1.4, 1.0}, {1.6, 2.0}, {-1.6, -2.0}, {-0.3, 0.0}}) {
    Sum sum;
    sum.add(value * 0x1p-60);
    EXPECT_EQ(sum.value(), units * 0x1p-60) << value;
  }
}

TEST(FixedSum, CancelsExactly) {
  EXPECT_EQ(sum_of({1e12, 1e-9, -1e12, -1e-9}), Sum());
  EXPECT_EQ(sum_of({1e12, 0x1p-60, -1e12}).value(), 0x1p-60);
}

TEST(FixedSum, LimitsSummands) {
  EXPECT_EQ(Sum::max(), 0x1p44);
  EXPECT_EQ(sum_of({1e300}).value(), Sum::max());
  EXPECT_EQ(sum_of({-1e300, -1e300}).value(), -2 * Sum::max());
  EXPECT_EQ(sum_of({std::numeric_limits<double>::denorm_min()}), Sum());
}

TEST(FixedSum, DoesNotDependOnTheOrder) {
  testing::Random random(7);
  std::vector<double> values;
  for (int i = 0; i < 4096; ++i) {
    const double sign = random.next() < 0.5f ? -1 : 1;
    values.push_back(sign * std::exp2(60.0 * static_cast<double>(random.next()) - 40.0));
  }
  const Sum forward = sum_of(values);
  double reference = 0;
  for (const double value : values) reference += value;
  EXPECT_NEAR(forward.value(), reference, 1e-6);
  std::reverse(values.begin(), values.end());
  EXPECT_EQ(sum_of(values), forward);
  const Sum first = sum_of({values.begin(), values.begin() + 1000});
  Sum parts = sum_of({values.begin() + 1000, values.end()});
  parts.add(first);
  EXPECT_EQ(parts, forward);
}

TEST(FixedSum, WideSumsHoldSquares) {
  FixedSum<3, 84> sum;
  sum.add(0x1p80);
  sum.add(0x1p-80);
  sum.add(-0x1p80);
  EXPECT_EQ(sum.value(), 0x1p-80);
  sum.add(0x1p63 * 3);
  EXPECT_EQ(sum.value(), 0x1p63 * 3);
}

TEST(FixedSum, OneWordHoldsSmallValues) {
  FixedSum<1, 38> sum;
  for (int i = 0; i < 1000; ++i) sum.add(-0.5);
  EXPECT_EQ(sum.value(), -500);
  EXPECT_EQ((FixedSum<1, 38>::max()), 4);
}

}  // namespace
}  // namespace relume
