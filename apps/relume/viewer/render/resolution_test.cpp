#include "viewer/render/resolution.h"

#include <gtest/gtest.h>

namespace relume::viewer {
namespace {

const IVec2 kFull(1280, 720);
constexpr double kBudget_s = 1.0 / 30;

/// Renders `frames` frames at `s_per_pixel`; returns the seconds of the last one.
double render(ResolutionControl& control, const IVec2& full, double s_per_pixel, int frames) {
  double seconds = 0;
  for (int i = 0; i < frames; ++i) {
    const IVec2 size = control.size(full);
    seconds = s_per_pixel * size.x * size.y;
    control.frame_done(seconds, kBudget_s, full);
  }
  return seconds;
}

TEST(ResolutionControl, GoesFromTheSmallestToTheFullSizeWhereThatIsFastEnough) {
  ResolutionControl control;
  EXPECT_EQ(control.size(kFull), IVec2(kMinWidth, kMinHeight)) << "whatever the machine, the first frames come soon";
  render(control, kFull, 0.5 * kBudget_s / (1280 * 720), 8);
  EXPECT_EQ(control.size(kFull), kFull);
  render(control, kFull, 0.5 * kBudget_s / (1280 * 720), 100);
  EXPECT_EQ(control.size(kFull), kFull);
}

TEST(ResolutionControl, MeetsTheBudgetWithinAFewFramesAndStays) {
  ResolutionControl control;
  const double s_per_pixel = 5 * kBudget_s / (1280 * 720);
  EXPECT_LE(render(control, kFull, s_per_pixel, 8), kBudget_s);
  const IVec2 settled = control.size(kFull);
  for (int i = 0; i < 200; ++i) {
    render(control, kFull, s_per_pixel, 1);
    ASSERT_EQ(control.size(kFull), settled) << "every change of size costs a history";
  }
  EXPECT_GT(settled.x * settled.y * s_per_pixel, 0.6 * kBudget_s) << "no more pixels given away than steps make it";
}

TEST(ResolutionControl, GrowsAgainWhenTheSceneBecomesEasier) {
  ResolutionControl control;
  render(control, kFull, 8 * kBudget_s / (1280 * 720), 10);
  EXPECT_LT(control.size(kFull).x, 700);
  render(control, kFull, 0.4 * kBudget_s / (1280 * 720), 200);
  EXPECT_EQ(control.size(kFull), kFull);
}

TEST(ResolutionControl, OneSlowFrameChangesNothing) {
  ResolutionControl control;
  render(control, kFull, 0.5 * kBudget_s / (1280 * 720), 8);
  control.frame_done(10 * kBudget_s, kBudget_s, kFull);
  control.frame_done(0.5 * kBudget_s, kBudget_s, kFull);
  EXPECT_EQ(control.size(kFull), kFull);
}

TEST(ResolutionControl, TheFirstFrameAfterARestKeepsToItsBudget) {
  ResolutionControl control;
  render(control, kFull, 1e-7, 8);
  const double s_per_pixel = 3e-6;  // 28 ms for 9,333 pixels
  control.measured(s_per_pixel * 1280 * 720, kFull);
  const IVec2 first = control.first_frame_size(kFull);
  EXPECT_NEAR(first.x * first.y * s_per_pixel, kFirstFrameBudget_s, 0.02 * kFirstFrameBudget_s);
  EXPECT_NEAR(static_cast<double>(first.x) / first.y, 16.0 / 9, 0.02);
  control.measured(1000, kFull);
  EXPECT_EQ(control.first_frame_size(kFull), IVec2(kMinWidth, kMinHeight));
}

TEST(ResolutionControl, TheFirstFrameAfterARestHasTheUsualSizeIfThatIsFastEnough) {
  ResolutionControl control;
  EXPECT_EQ(control.first_frame_size(kFull), control.size(kFull)) << "nothing is known yet";
  control.measured(1e-9 * 1280 * 720, kFull);
  EXPECT_EQ(control.first_frame_size(kFull), control.size(kFull));
}

TEST(ResolutionControl, UpscalesBeforeItLowersTheSize) {
  ResolutionControl control;
  control.allow_upscaling(true);
  // A full frame takes twice the budget, and half of that if it is upscaled.
  const auto frame = [&](double full_s) {
    const IVec2 size = control.size(kFull);
    const double seconds = full_s * size.x * size.y / (1280.0 * 720) * (control.upscale() > 1 ? 0.4 : 1.0);
    control.frame_done(seconds, kBudget_s, kFull);
  };
  for (int i = 0; i < 40; ++i) frame(2 * kBudget_s);
  EXPECT_EQ(control.size(kFull), kFull);
  EXPECT_EQ(control.upscale(), 2);
  for (int i = 0; i < 200; ++i) frame(0.3 * kBudget_s);
  EXPECT_EQ(control.size(kFull), kFull);
  EXPECT_EQ(control.upscale(), 1) << "a fast machine traces a path in every pixel";
  for (int i = 0; i < 40; ++i) {
    frame(1.2 * kBudget_s);
    ASSERT_EQ(control.size(kFull), kFull) << "no size in between, which would discard histories";
  }
  EXPECT_EQ(control.upscale(), 2);
  control.measured(2 * kBudget_s, kFull);
  EXPECT_EQ(control.first_frame_size(kFull), kFull) << "also after a rest";
  for (int i = 0; i < 40; ++i) frame(100 * kBudget_s);
  EXPECT_LT(control.size(kFull).x, 400);
  EXPECT_EQ(control.upscale(), 2);
}

TEST(ResolutionControl, NeverGoesBelowTheSmallestSize) {
  ResolutionControl control;
  render(control, kFull, 1000 * kBudget_s / (1280 * 720), 50);
  EXPECT_EQ(control.size(kFull), IVec2(kMinWidth, kMinHeight));
  const IVec2 square(400, 400);
  EXPECT_GE(control.size(square).x, kMinWidth) << "the narrower side counts";
  const IVec2 tiny(64, 48);
  EXPECT_EQ(control.size(tiny), tiny);
}

}  // namespace
}  // namespace relume::viewer
