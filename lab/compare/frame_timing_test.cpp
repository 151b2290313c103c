#include "compare/frame_timing.h"

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"

namespace relume {
namespace {

/// One microsecond per ray, independent of machine and load.
double ray_clock(const Session& session) { return 1e-6 * static_cast<double>(session.statistics().rays); }

RenderSettings settings_with_bounces(int max_bounces) {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.path.max_bounces = max_bounces;
  return settings;
}

TEST(FrameTiming, RatiosAreToTheFirstContender) {
  const Scene scene = find_builtin_scene("cornell-closed")->build();
  const std::vector<TimedContender> contenders{{"none", settings_with_bounces(0)}, {"four", settings_with_bounces(4)}};
  const auto timings = time_frames(scene, contenders, 8, {}, {}, ray_clock);
  ASSERT_TRUE(timings);
  ASSERT_EQ(timings->size(), 2u);
  const FrameTiming& first = timings->front();
  EXPECT_EQ(first.name, "none");
  EXPECT_EQ(first.ratio, 1);
  EXPECT_NEAR(first.ms, 0.192, 1e-9);  // one ray per pixel
  const FrameTiming& second = timings->back();
  EXPECT_GT(second.ratio, 2);
  EXPECT_NEAR(second.ms / first.ms, second.ratio, 1e-6);
  EXPECT_LE(second.ratio_interval.low, second.ratio);
  EXPECT_GE(second.ratio_interval.high, second.ratio);
  double passes = 0;
  for (const auto& [name, ms] : second.pass_ms) passes += ms;
  EXPECT_GT(passes, 0);
}

TEST(FrameTiming, StopsWhenAsked) {
  std::stop_source source;
  int rounds = 0;
  const auto timings = time_frames(
      find_builtin_scene("furnace")->build(), {{"one", settings_with_bounces(1)}}, 100, source.get_token(),
      [&](double) { rounds += 1, source.request_stop(); }, ray_clock);
  EXPECT_FALSE(timings);
  EXPECT_EQ(rounds, 1);
}

TEST(FrameTiming, PassesOfAllContendersAreColumns) {
  FrameTiming plain{.name = "a", .ms = 2};
  plain.pass_ms = {{"trace", 1.5}};
  FrameTiming filtered{.name = "b", .ms = 4};
  filtered.pass_ms = {{"trace", 1.5}, {"filter", 2}};
  EXPECT_EQ(to_csv({plain, filtered}),
            "name,ms,ms_low,ms_high,ratio,ratio_low,ratio_high,trace ms,filter ms\n"
            "a,2,0,0,1,0,0,1.5,\n"
            "b,4,0,0,1,0,0,1.5,2\n");
}

}  // namespace
}  // namespace relume
