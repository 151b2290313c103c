#include "experiments/measure/estimate.h"

#include <gtest/gtest.h>

#include "experiments/experiment.h"
#include "metrics/testing/noisy_images.h"

namespace relume {
namespace {

using testing::reference;
using testing::repetitions;

TEST(Verdict, NoiseDecidesNothing) {
  const Image truth = reference();
  const auto compared = [&](float a, float b, float spread) {
    const Estimate first = squared_bias(repetitions(6, a, spread, 100), truth, 0);
    const Estimate second = squared_bias(repetitions(6, b, spread, 900), truth, 0);
    return std::string(verdict_below(difference(first, second)));
  };
  EXPECT_EQ(compared(0.1f, 0.5f, 0.1f), kVerdictHolds);
  EXPECT_EQ(compared(0.5f, 0.1f, 0.1f), kVerdictFails);
  EXPECT_EQ(compared(0.1f, 0.1f, 3), kVerdictUndecided);
  EXPECT_EQ(compared(0.1f, 0.11f, 3), kVerdictUndecided);  // would hold with less noise
  EXPECT_EQ(compared(0.1f, 0.11f, 0.01f), kVerdictHolds);
}

TEST(Verdict, AMarginDecidesEquality) {
  const Image truth = reference();
  const Estimate a = squared_bias(repetitions(6, 0.5f, 0.001f, 100), truth, 0);
  const Estimate b = squared_bias(repetitions(6, 0.5f, 0.001f, 900), truth, 0);
  EXPECT_STREQ(verdict_below(difference(a, scaled(b, 1.05))), kVerdictHolds);
  EXPECT_STREQ(verdict_below(difference(a, scaled(b, 0.95))), kVerdictFails);
}

TEST(Verdict, OneClaimThatFailsDecides) {
  EXPECT_STREQ(verdict_of_all({kVerdictHolds, kVerdictUndecided, kVerdictFails}), kVerdictFails);
  EXPECT_STREQ(verdict_of_all({kVerdictHolds, kVerdictUndecided}), kVerdictUndecided);
  EXPECT_STREQ(verdict_of_all({kVerdictHolds, kVerdictHolds}), kVerdictHolds);
}

}  // namespace
}  // namespace relume
