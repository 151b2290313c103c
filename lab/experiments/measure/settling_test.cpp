#include "experiments/measure/settling.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr size_t kFrames = 32;

/// Two runs whose errors fall from `first` to `last` within `frames` frames, and stay there. They differ by 1 %.
Adaptation falling(double first, double last, size_t frames) {
  Adaptation adaptation{"a", {}};
  for (const double scale : {0.995, 1.005}) {
    std::vector<double>& run = adaptation.runs.emplace_back();
    for (size_t i = 0; i < kFrames; ++i) run.push_back(scale * (i < frames ? first : last));
  }
  return adaptation;
}

TEST(Settling, OfSingleFramesEndsAtTheMeanOfTheLastQuarter) {
  const Settling settling{falling(4, 1, 6)};
  EXPECT_NEAR(over_settled(settling, 0).value, 4, 1e-9);
  EXPECT_NEAR(over_settled(settling, 4).value, 2.5, 1e-9);  // two frames before, two after
  EXPECT_NEAR(over_settled(settling, 6).value, 1, 1e-9);
  EXPECT_EQ(frames_until_settled(settling), 7u);
  EXPECT_EQ(settled_text(settling), "from frame 7 on");
}

TEST(Settling, OfImprovingImagesEndsAtTheErrorOfNewSessions) {
  Settling settling{falling(4, 1, 6), falling(4, 1, 6)};
  EXPECT_EQ(frames_until_settled(settling), 1u);  // stale light would make it worse than a new session
  settling.fresh = falling(1, 1, 0);
  EXPECT_EQ(frames_until_settled(settling), 7u);
  settling.fresh = falling(0.5, 0.5, 0);
  EXPECT_EQ(frames_until_settled(settling), 0u);
  EXPECT_EQ(settled_text(settling), "not within 32 frames");
}

TEST(Settling, IsUnknownBelowTheReferencesNoise) {
  EXPECT_EQ(frames_until_settled({falling(1, 1, 0), falling(-1, -1, 0)}), 0u);
}

}  // namespace
}  // namespace relume
