#include "techniques/transport/path/indirect_rate.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr uint32_t kEdge = kBlueNoiseEdge;

TEST(IndirectRate, AllPathsContinueByDefault) {
  EXPECT_EQ(IndirectRate{}.weight(3, 5), 1.0f);
  EXPECT_EQ(indirect_rate(1, {}).weight(3, 5), 1.0f);
}

TEST(IndirectRate, EachFrameHasItsShareOfPixels) {
  for (const float rate : {0.0625f, 0.3f, 0.5f, 0.75f}) {
    for (uint32_t frame = 0; frame < 20; ++frame) {
      const IndirectRate indirect = indirect_rate(rate, {.seed = 7, .frame = frame});
      double sum = 0;
      for (uint32_t i = 0; i < kEdge * kEdge; ++i) sum += static_cast<double>(indirect.weight(i % kEdge, i / kEdge));
      EXPECT_NEAR(sum / (kEdge * kEdge), 1, 1e-3 / static_cast<double>(rate)) << rate << " in frame " << frame;
    }
  }
}

TEST(IndirectRate, EachPixelHasItsShareOfFrames) {
  constexpr uint32_t kFrames = 1000;
  for (const uint32_t x : {0u, 17u, 63u, 130u}) {
    double sum = 0;
    uint32_t gap = 0, longest = 0;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
      const float weight = indirect_rate(0.5f, {.seed = 1, .frame = frame}).weight(x, 2 * x);
      sum += static_cast<double>(weight);
      gap = weight > 0.0f ? 0 : gap + 1;
      longest = std::max(longest, gap);
    }
    EXPECT_NEAR(sum / kFrames, 1, 0.01);
    EXPECT_LE(longest, 2u);  // independent choices would leave about 9 frames in a row without indirect light
  }
}

TEST(IndirectRate, EachPixelOfEachFrameHasItsProbability) {
  constexpr int kSeeds = 20000;
  constexpr float kRate = 0.3f;
  for (const uint32_t frame : {0u, 5u}) {
    int chosen = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed)
      chosen += indirect_rate(kRate, {.seed = seed, .frame = frame}).weight(11, 40) > 0.0f ? 1 : 0;
    const double deviation = std::sqrt(kSeeds * kRate * (1 - kRate));
    EXPECT_NEAR(chosen, kSeeds * kRate, 4.5 * deviation);
  }
}

}  // namespace
}  // namespace relume
