#include "sampling/chi2_bound.h"

#include <gtest/gtest.h>

#include "testing/chi2.h"

namespace relume {
namespace {

TEST(Chi2Bound, HoldsAndIsTight) {
  for (const int count : {1, 9, 100, 10000}) {
    for (const float t : {0.5f, 1.5f, 3.0f}) {
      const double bound = 1.0 + static_cast<double>(chi2_mean_bound(static_cast<float>(count), t));
      const double allowed = std::exp(-0.5 * static_cast<double>(t * t));
      EXPECT_LE(testing::chi2_survival(count * bound, count), allowed) << count << ' ' << t;
      // 0.3 of that excess is not so rare.
      EXPECT_GT(testing::chi2_survival(count * (1.0 + 0.3 * (bound - 1.0)), count), 0.2 * allowed) << count << ' ' << t;
    }
  }
}

}  // namespace
}  // namespace relume
