#include "experiments/measure/estimate.h"

#include <gtest/gtest.h>

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
  EXPECT_EQ(compared(0.1f, 0.11f, 3), kVerdictUndecided);  // with less noise it would hold
  EXPECT_EQ(compared(0.1f, 0.11f, 0.01f), kVerdictHolds);
}

TEST(Verdict, AMarginDecidesWhatIsEqual) {
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
