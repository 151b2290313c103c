#include "render/stop_criteria.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// A session with frames of one second each and the theoretical decrease of the error.
struct FakeSession {
  uint32_t samples = 0;
  double clock_s = 100;
  double frame_s = 1;
  double error_of_one = 1;
  std::stop_source stop_source;
  double samples_a_frame = 1;
  uint32_t interrupt_at = 0;  ///< frame in which a stop is requested; 0: never

  bool render_frame(const std::stop_token& stop) {
    clock_s += frame_s;
    if (samples + 1 == interrupt_at) stop_source.request_stop();
    if (stop.stop_requested()) return false;
    ++samples;
    return true;
  }

  StopReason run(const RenderLimits& criteria) {
    const FrameSource source{
        .render_frame = [this](std::stop_token stop) { return render_frame(stop); },
        .image_frames = [this] { return samples; },
        .image_samples = [this] { return samples * samples_a_frame; },
        .estimated_error = [this] { return error_of_one / std::sqrt(samples); },
    };
    return render_until(
        source, criteria, [this] { return clock_s; }, stop_source.get_token(),
        [this](const RenderProgress& state) { seen.push_back(state); });
  }

  std::vector<RenderProgress> seen;
};

TEST(RenderUntil, StopsAtTheSampleCount) {
  FakeSession session;
  EXPECT_EQ(session.run({.samples = 5}), StopReason::samples);
  EXPECT_EQ(session.samples, 5u);
  ASSERT_EQ(session.seen.size(), 5u);
  EXPECT_EQ(session.seen.back().frames_done_here, 5u);
  EXPECT_DOUBLE_EQ(session.seen.back().elapsed_s, 5);
}

TEST(RenderUntil, CountsSamplesWhereFramesHaveFewer) {
  FakeSession session;
  session.samples_a_frame = 0.25;
  EXPECT_EQ(session.run({.samples = 5}), StopReason::samples);
  EXPECT_EQ(session.samples, 20u) << "frames";
  EXPECT_DOUBLE_EQ(fraction_done(session.seen[9], {.samples = 5}), 0.5);
  EXPECT_DOUBLE_EQ(remaining_s(session.seen[9], {.samples = 5}), 10);
}

TEST(RenderUntil, CountsTheSamplesOfACheckpoint) {
  FakeSession session;
  session.samples = 3;
  EXPECT_EQ(session.run({.samples = 5}), StopReason::samples);
  EXPECT_EQ(session.seen.size(), 2u);
  EXPECT_EQ(session.run({.samples = 5}), StopReason::samples);
  EXPECT_EQ(session.seen.size(), 2u) << "nothing was left to do";
}

TEST(RenderUntil, KeepsWithinTheTime) {
  FakeSession session;
  session.frame_s = 3;
  EXPECT_EQ(session.run({.time_s = 10}), StopReason::time);
  EXPECT_EQ(session.samples, 3u) << "a fourth frame would end after 12 s";
}

TEST(RenderUntil, CompletesAtLeastOneFrame) {
  FakeSession session;
  session.frame_s = 60;
  EXPECT_EQ(session.run({.time_s = 0.001}), StopReason::time);
  EXPECT_EQ(session.samples, 1u);
}

TEST(RenderUntil, StopsAtTheError) {
  FakeSession session;
  EXPECT_EQ(session.run({.error = 0.1}), StopReason::error);
  // 1/sqrt(n) <= 0.1 from n = 100 on, a multiple of four at which the error is checked.
  EXPECT_EQ(session.samples, 100u);
}

TEST(RenderUntil, ResumedRenderStopsAtTheErrorWhereAnUninterruptedOneDoes) {
  FakeSession whole;
  whole.run({.error = 0.09});
  FakeSession first;
  first.run({.samples = 37});
  first.run({.error = 0.09});
  EXPECT_EQ(first.samples, whole.samples);
}

TEST(RenderUntil, FirstCriterionWins) {
  FakeSession session;
  EXPECT_EQ(session.run({.samples = 1000, .time_s = 20, .error = 1e-6}), StopReason::time);
  EXPECT_EQ(session.samples, 20u);
}

TEST(RenderUntil, InterruptDropsTheFrameInProgress) {
  FakeSession session;
  session.interrupt_at = 4;
  EXPECT_EQ(session.run({.samples = 10}), StopReason::interrupted);
  EXPECT_EQ(session.samples, 3u);
}

TEST(RenderUntil, InterruptDuringTheFirstFrameStillGivesAnImage) {
  FakeSession session;
  session.interrupt_at = 1;
  EXPECT_EQ(session.run({.samples = 10}), StopReason::interrupted);
  EXPECT_EQ(session.samples, 1u);
}

TEST(RenderUntil, InterruptAfterTheLastSampleIsACompleteImage) {
  FakeSession session;
  session.interrupt_at = 1;
  EXPECT_EQ(session.run({.samples = 1}), StopReason::samples);
}

TEST(RenderUntil, EndsASession) {
  RenderSettings settings;
  settings.width = settings.height = 16;
  Session session(find_builtin_scene("furnace")->build(), settings);
  EXPECT_EQ(render_until(session, {.samples = 3}), StopReason::samples);
  EXPECT_EQ(session.image_frames(), 3u);
  EXPECT_EQ(render_until(session, {.time_s = 0.01}), StopReason::time);
  EXPECT_EQ(render_until(session, {.error = 0.5}), StopReason::error);
  std::stop_source stop;
  int frames = 0;
  const auto stop_at_two = [&](const RenderProgress&) {
    if (++frames == 2) stop.request_stop();
  };
  EXPECT_EQ(render_until(session, {.samples = 1000000}, stop.get_token(), stop_at_two), StopReason::interrupted);
  EXPECT_EQ(frames, 2);
}

TEST(RenderLimits, DefaultAppliesOnlyWithoutAny) {
  EXPECT_EQ(stop_criteria({}).samples, static_cast<uint32_t>(kDefaultSpp));
  EXPECT_EQ(stop_criteria({.time_s = 10}).samples, 0u);
  EXPECT_EQ(stop_criteria({.error = 0.1f}).samples, 0u);
  EXPECT_EQ(stop_criteria({.spp = 7, .time_s = 10}).samples, 7u);
}

TEST(RenderLimits, ErrorIsCheckedMoreRarelyAsItChangesLess) {
  EXPECT_FALSE(checks_error_at(0));
  EXPECT_FALSE(checks_error_at(15));
  EXPECT_TRUE(checks_error_at(16));
  EXPECT_TRUE(checks_error_at(17));
  EXPECT_FALSE(checks_error_at(33));
  EXPECT_TRUE(checks_error_at(34));
  EXPECT_FALSE(checks_error_at(1024 + 32));
  EXPECT_TRUE(checks_error_at(1024 + 64));
}

TEST(Progress, FractionFollowsTheNearestCriterion) {
  const RenderProgress state{
      .frames = 25, .samples = 25, .elapsed_s = 10, .frames_done_here = 25, .samples_done_here = 25, .error = 0.2};
  EXPECT_DOUBLE_EQ(fraction_done(state, {.samples = 100}), 0.25);
  EXPECT_DOUBLE_EQ(fraction_done(state, {.samples = 100, .time_s = 20}), 0.5);
  EXPECT_DOUBLE_EQ(fraction_done(state, {.error = 0.1}), 0.25);  // a quarter of the required samples
  EXPECT_DOUBLE_EQ(fraction_done(state, {.error = 0.3}), 1);
}

TEST(Progress, RemainingTimeFollowsTheNearestCriterion) {
  const RenderProgress state{
      .frames = 25, .samples = 25, .elapsed_s = 10, .frames_done_here = 20, .samples_done_here = 20, .error = 0.2};
  EXPECT_DOUBLE_EQ(remaining_s(state, {.samples = 100}), 0.5 * 75);
  EXPECT_DOUBLE_EQ(remaining_s(state, {.samples = 100, .time_s = 12}), 2);
  EXPECT_NEAR(remaining_s(state, {.error = 0.1}), 0.5 * 75, 1e-9);  // allows for rounding of (0.2 / 0.1)²
  EXPECT_TRUE(std::isinf(remaining_s({}, {.samples = 100})));
  EXPECT_TRUE(std::isinf(remaining_s(
      {.frames = 1, .samples = 1, .elapsed_s = 1, .frames_done_here = 1, .samples_done_here = 1}, {.error = 0.1})));
}

}  // namespace
}  // namespace relume
