#include "viewer/model/fly_pace.h"

#include <gtest/gtest.h>

#include <utility>

namespace relume::viewer {
namespace {

constexpr double kTick_s = 1.0 / 36;  // interval of interface frames

/// Holds a key for `held_s` while frames take `frame_s`, and continues `watched_s` longer. Returns the seconds of all
/// steps.
double flown(double frame_s, double held_s, double watched_s) {
  FlyPace pace;
  uint64_t version = 0;
  uint64_t shown = 0;
  uint64_t rendering = 0;
  double done_s = 0;
  double sum = 0;
  for (double now_s = 0; now_s < held_s + watched_s; now_s += kTick_s) {
    if (rendering > 0 && now_s >= done_s) shown = std::exchange(rendering, 0);
    const float step = pace.step(now_s < held_s, shown, now_s);
    if (step > 0) pace.posted(++version);
    sum += static_cast<double>(step);
    if (rendering == 0 && shown < version) {
      rendering = version;
      done_s = now_s + frame_s;
    }
  }
  return sum;
}

TEST(FlyPace, KeepsUpWithTheClockWhereFramesAreFast) { EXPECT_NEAR(flown(0.05, 2, 0), 2, 0.1); }

TEST(FlyPace, FliesNoFurtherThanFramesAllow) {
  // Two frames are shown, and a third is in progress.
  EXPECT_LE(flown(1, 2.5, 0), kFirstStep_s + 2 * kLongestStep_s + 1e-6);
  EXPECT_GT(flown(1, 2.5, 0), kLongestStep_s);
}

TEST(FlyPace, ReleasedKeysStopMoving) {
  for (const double frame_s : {0.05, 0.4, 2.0}) EXPECT_EQ(flown(frame_s, 0.5, 10), flown(frame_s, 0.5, 0)) << frame_s;
}

TEST(FlyPace, PressingAgainDoesNotGetAroundTheFrame) {
  FlyPace pace;
  EXPECT_GT(pace.step(true, 0, 0), 0);
  pace.posted(1);
  for (int i = 1; i < 20; ++i) EXPECT_EQ(pace.step(i % 2 == 0, 0, 0.1 * i), 0) << i;
  EXPECT_GT(pace.step(true, 1, 3), 0) << "the first step has been shown";
}

TEST(FlyPace, OneStepPerRequest) {
  FlyPace pace;
  EXPECT_GT(pace.step(true, 0, 0), 0);
  EXPECT_EQ(pace.step(true, 0, 1), 0) << "nothing has been asked for yet";
}

}  // namespace
}  // namespace relume::viewer
