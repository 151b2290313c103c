#include "techniques/transport/path/indirect_rate.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr uint32_t kEdge = kBlueNoiseEdge;

TEST(IndirectRate, AllPathsContinueByDefault) {
  EXPECT_EQ(IndirectRate{}.weight(3, 5), 1.0f);
  EXPECT_EQ(indirect_rate(1, {}, blue_noise_tile()).weight(3, 5), 1.0f);
}

TEST(IndirectRate, EachFrameHasItsShareOfPixels) {
  for (const float rate : {0.0625f, 0.3f, 0.5f, 0.75f}) {
    for (uint32_t frame = 0; frame < 20; ++frame) {
      const IndirectRate indirect = indirect_rate(rate, {.seed = 7, .frame = frame}, blue_noise_tile());
      double sum = 0;
      for (uint32_t i = 0; i < kEdge * kEdge; ++i) sum += static_cast<double>(indirect.weight(i % kEdge, i / kEdge));
      EXPECT_NEAR(sum / (kEdge * kEdge), 1, 1e-3 / static_cast<double>(rate)) << rate << " in frame " << frame;
    }
  }
}

/// With temporal upscaling, a pixel has a sample in every n²-th frame only.
TEST(IndirectRate, EachPixelHasItsShareOfFrames) {
  constexpr uint32_t kFrames = 2000;
  for (const uint32_t stride : {1u, 4u, 9u, 16u}) {
    for (const uint32_t x : {0u, 17u, 63u, 130u}) {
      double sum = 0;
      double pairs = 0;
      double before = 1;
      for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const double weight = static_cast<double>(
            indirect_rate(0.5f, {.seed = 1, .frame = stride * frame}, blue_noise_tile()).weight(x, 2 * x));
        sum += weight;
        pairs += (weight - 1) * (before - 1);
        before = weight;
      }
      const double deviation = 1 / std::sqrt(kFrames);  // weights are 0 or 2
      EXPECT_NEAR(sum / kFrames, 1, 4.5 * deviation) << stride;
      EXPECT_NEAR(pairs / kFrames, 0, 4.5 * deviation) << stride << ": neighbouring samples are independent";
    }
  }
}

TEST(IndirectRate, EachPixelOfEachFrameHasItsProbability) {
  constexpr int kSeeds = 20000;
  constexpr float kRate = 0.3f;
  for (const uint32_t frame : {0u, 5u}) {
    int chosen = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed)
      chosen += indirect_rate(kRate, {.seed = seed, .frame = frame}, blue_noise_tile()).weight(11, 40) > 0.0f ? 1 : 0;
    const double deviation = std::sqrt(kSeeds * kRate * (1 - kRate));
    EXPECT_NEAR(chosen, kSeeds * kRate, 4.5 * deviation);
  }
}

}  // namespace
}  // namespace relume
