#include <gtest/gtest.h>

#include "compare/comparison.h"

namespace relume {
namespace {

/// A comparison with three equal repetitions.
Comparison compared(const Repetition& repetition) {
  Comparison c;
  c.reference.spp = 64;
  c.contenders.push_back({.name = "it", .is_image = false, .settings = "{}"});
  c.contenders.back().repetitions.assign(3, repetition);
  return c;
}

TEST(Limits, NoiseOfTheReferenceIsTooMuchInAnyFigure) {
  Comparison c = compared({.mse = 1, .rel_mse = 0.5});
  c.reference_noise = {.mse = 0.09, .rel_mse = 0.04};
  EXPECT_TRUE(limits_of(c).empty());
  c.reference_noise.rel_mse = 0.2;
  ASSERT_EQ(limits_of(c).size(), 1u);
  EXPECT_EQ(limits_of(c).front(),
            "The reference's own noise is 40 % of the relMSE of it; raise --reference-spp to lower it.");
  c.reference_noise.mse = 0.1;
  EXPECT_EQ(
      limits_of(c).front(),
      "The reference's own noise is 10 % of the MSE and 40 % of the relMSE of it; raise --reference-spp to lower it.");
}

TEST(Limits, AnimationsAreWarnedOfToo) {
  Comparison c = compared({.mse = 1, .rel_mse = 1, .temporal_error = 0.5});
  c.options.times_s = {0, 0.1f};
  c.reference_noise = {.mse = 0.2, .rel_mse = 0.01, .temporal_error = 0.1};
  ASSERT_EQ(limits_of(c).size(), 1u);
  EXPECT_EQ(limits_of(c).front(),
            "The reference's own noise is 20 % of the MSE and 20 % of the temporal error of it; raise --reference-spp "
            "to lower it.");
}

TEST(Limits, AFileHasNoKnownError) {
  Comparison c = compared({.mse = 1, .rel_mse = 1});
  c.reference.spp = 0;
  ASSERT_EQ(limits_of(c).size(), 1u);
  EXPECT_NE(limits_of(c).front().find("includes its unknown error"), std::string::npos);
}

TEST(Limits, PixelsThatAreNotFinite) {
  Comparison c = compared({.mse = 1, .rel_mse = 1});
  c.contenders.back().repetitions[1].nonfinite = 7;
  c.reference_nonfinite = 2;
  const std::vector<std::string> notes = limits_of(c);
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_NE(notes[0].find("The reference has pixels that are not finite (2)"), std::string::npos);
  EXPECT_NE(notes[1].find("it has pixels that are not finite (7 at most in a repetition)"), std::string::npos);
}

}  // namespace
}  // namespace relume
