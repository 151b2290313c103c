#include "techniques/transport/bdpt/partial_weights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

TEST(PartialWeights, StayNumbersBeyondTheRangeOfAFloat) {
  // A small light 10⁹ m away: its squared densities overflow.
  for (const bool can_be_hit : {false, true}) {
    SubpathWeights weights = SubpathWeights::start(0.08f, can_be_hit ? 1e25f : 0.0f, 1.0f, 1.0f, false);
    const PartialWeights far = weights.arrive(0.5f, 1e18f);
    EXPECT_FALSE(std::isnan(far.a) || std::isnan(far.b));
    EXPECT_EQ(far.sum(0.0f, 1.0f), 0.0f);
    EXPECT_FALSE(std::isnan(far.sum(1e-18f, 0.0f)));
    weights.leave_delta(0.5f, 0.0f);
    const PartialWeights behind_glass = weights.arrive(0.5f, 1e18f);
    EXPECT_EQ(behind_glass.a, 0.0f);
    EXPECT_EQ(behind_glass.b, 0.0f);
  }
}

}  // namespace
}  // namespace relume
