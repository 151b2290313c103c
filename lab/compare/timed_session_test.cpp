#include "compare/timed_session.h"

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"

namespace relume {
namespace {

TEST(EqualTime, CountsFillTheBudget) {
  // 10 ms and 25 ms per frame.
  std::vector<std::vector<double>> cumulative(2);
  for (int i = 1; i <= 300; ++i) cumulative[0].push_back(0.010 * i);
  for (int i = 1; i <= 120; ++i) cumulative[1].push_back(0.025 * i);
  const EqualTime equal = equal_time(cumulative, 2.0);
  EXPECT_EQ(equal.frames, (std::vector<uint32_t>{200, 80}));
  EXPECT_LT(equal.spread(), 1e-9);
}

TEST(EqualTime, SmallBudgetsMoveToEqualTimes) {
  // 30 ms and 40 ms in 100 ms: at 120 ms, 4 and 3 frames agree, where 100 ms would give 90 against 80 or 120.
  std::vector<std::vector<double>> cumulative(2);
  for (int i = 1; i <= 6; ++i) {
    cumulative[0].push_back(0.030 * i);
    cumulative[1].push_back(0.040 * i);
  }
  const EqualTime equal = equal_time(cumulative, 0.1);
  EXPECT_EQ(equal.frames, (std::vector<uint32_t>{4, 3}));
  EXPECT_LT(equal.spread(), 1e-9);
}

TEST(EqualTime, EveryContenderRendersAFrame) {
  const EqualTime equal = equal_time({{0.5}, {0.02, 0.04, 0.06, 0.08}}, 0.05);
  EXPECT_EQ(equal.frames[0], 1u);
  EXPECT_GT(equal.spread(), 4);
}

TEST(EqualTime, FramesThatGetCheaperCountAsTheyAre) {
  std::vector<double> falling;
  double sum = 0;
  for (int i = 0; i < 100; ++i) falling.push_back(sum += i < 4 ? 0.020 : 0.005);
  std::vector<double> steady;
  for (int i = 1; i <= 100; ++i) steady.push_back(0.010 * i);
  const EqualTime equal = equal_time({falling, steady}, 0.3);
  EXPECT_EQ(equal.frames[1], 30u);
  EXPECT_EQ(equal.frames[0], 4u + 44u);  // 4 · 20 ms + 44 · 5 ms
}

TEST(EqualTime, InterruptedFramesDoNotCount) {
  std::vector<double> frames(20, 0.010);
  frames[7] = 0.5;
  EXPECT_NEAR(cumulative_time(frames).back(), 0.2, 1e-9);
}

TEST(EqualTime, PeriodicWorkIsNotAnInterruption) {
  // A denoiser that only filters every eighth frame.
  std::vector<double> frames(64, 0.010);
  for (size_t i = 7; i < frames.size(); i += 8) frames[i] = 0.050;
  EXPECT_NEAR(cumulative_time(frames).back(), 56 * 0.010 + 8 * 0.050, 1e-9);
}

TEST(EqualTime, FirstFramePreparationCounts) {
  std::vector<double> frames(20, 0.010);
  frames[0] = 0.5;
  EXPECT_NEAR(cumulative_time(frames).back(), 0.69, 1e-9);
  EXPECT_NEAR(cumulative_time(frames).front(), 0.5, 1e-9);
}

TEST(TimedSession, CountsSinceTheRestart) {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  TimedSession session(find_builtin_scene("cornell")->build(), settings);
  session.restart(1);
  for (int i = 0; i < 3; ++i) session.render_frame();
  EXPECT_EQ(session.frames(), 3u);
  EXPECT_DOUBLE_EQ(session.samples_per_pixel(), 3);
  EXPECT_GT(session.time_s(), 0);
  const Image first = session.session().image();
  double passes = 0;
  for (const PassTime& pass : session.passes()) passes += pass.seconds;
  EXPECT_GT(passes, 0);
  EXPECT_LE(passes, session.time_s());
  session.restart(2);
  EXPECT_EQ(session.frames(), 0u);
  EXPECT_EQ(session.samples_per_pixel(), 0);
  for (int i = 0; i < 3; ++i) session.render_frame();
  EXPECT_NE(first.pixels, session.session().image().pixels);
  // A restart gives the bits of a new session.
  session.restart(1);
  for (int i = 0; i < 3; ++i) session.render_frame();
  EXPECT_EQ(first.pixels, session.session().image().pixels);
}

TEST(TimedSession, ARestartDiscardsHistories) {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.history = HistoryChoice::reproject;
  settings.allocation = AllocationChoice::adaptive;
  const Scene scene = find_builtin_scene("cornell-closed")->build();
  TimedSession fresh(scene, settings);
  fresh.restart(4);
  TimedSession used(scene, settings);
  used.restart(9);
  for (int i = 0; i < 6; ++i) {
    used.session().set_time(0.1f * static_cast<float>(i));
    used.render_frame();
  }
  used.session().set_time(0);
  used.restart(4);
  for (int i = 0; i < 5; ++i) {
    fresh.render_frame();
    used.render_frame();
  }
  EXPECT_EQ(fresh.session().image().pixels, used.session().image().pixels);
}

}  // namespace
}  // namespace relume
