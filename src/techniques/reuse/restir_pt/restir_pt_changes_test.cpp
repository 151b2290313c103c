// Tests what becomes of reservoirs when lights change, and the losses of the modes that are known to lose light.
#include <vector>

#include <gtest/gtest.h>

#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_gi/testing/posts.h"

namespace relume {
namespace {

using testing::error_of;
using testing::Measured;

RenderSettings settings_of(PathCorrection correction) {
  RenderSettings settings = testing::reuse_settings(ReuseChoice::restir_pt);
  settings.history = HistoryChoice::none;
  settings.restir_pt.correction = correction;
  settings.restir_pt.radius = 6;
  return settings;
}

RenderSettings paths() {
  RenderSettings settings = testing::reuse_settings(ReuseChoice::none);
  settings.history = HistoryChoice::accumulate;
  return settings;
}

constexpr float kBright = 20;
constexpr float kDim = 5;

/// Mean of the image of frame `after` since the lamp was dimmed to a quarter.
Measured after_dimming(const RenderSettings& settings, int after) {
  Session session(testing::posts(), settings);
  std::vector<double> means;
  for (int seed = 1; seed <= 8; ++seed) {
    session.set_light(0, testing::ceiling_lamp(Rgb(kBright)));
    session.restart(seed);
    for (int i = 0; i < 6; ++i) session.render_frame();
    session.set_light(0, testing::ceiling_lamp(Rgb(kDim)));
    for (int i = 0; i < after; ++i) session.render_frame();
    means.push_back(testing::means_of(session.image())[0]);
  }
  return testing::measured_over(means);
}

TEST(RestirPtLightChange, EndsReservoirsIfExact) {
  const Measured truth = after_dimming(paths(), 64);
  const Measured first = after_dimming(settings_of(PathCorrection::exact), 1);
  EXPECT_NEAR(first.mean, truth.mean, 6 * error_of(first, truth));
}

/// Light that arrives at a joint is stored, but lights to which it connects itself are evaluated again. Only the
/// weights compare the old light with the new.
TEST(RestirPtLightChange, IsFollowedAtTheJoint) {
  RenderSettings settings = settings_of(PathCorrection::lagging);
  settings.restir_pt.shift = PathShiftKind::reconnection;
  const Measured truth = after_dimming(paths(), 64);
  const Measured second = after_dimming(settings, 2);
  EXPECT_NEAR(second.mean, truth.mean, 0.25 * truth.mean + 6 * error_of(second, truth));
}

/// Mean over seeds, between posts that hide parts of the ceiling.
Measured between_posts(RenderSettings settings) {
  settings.history = HistoryChoice::accumulate;
  settings.restir_pt.cap = 8;
  return testing::after_moves(testing::posts(), settings, 20, 6, 8)[0];
}

TEST(RestirPtBasic, LosesLightBetweenPosts) {
  const Measured truth = testing::after_moves(testing::posts(), paths(), 8, 6, 64)[0];
  const Measured basic = between_posts(settings_of(PathCorrection::basic));
  EXPECT_LT(basic.mean - truth.mean, -4.5 * error_of(basic, truth));
  EXPECT_GT(basic.mean, 0.4 * truth.mean);
}

TEST(RestirPtConstant, LosesLightBetweenPosts) {
  const Measured truth = testing::after_moves(testing::posts(), paths(), 8, 6, 64)[0];
  const Measured constant = between_posts(settings_of(PathCorrection::constant));
  EXPECT_LT(constant.mean - truth.mean, -4.5 * error_of(constant, truth));
  EXPECT_GT(constant.mean, 0.2 * truth.mean);
}

/// The confidence of a history then depends on its path: a small bias. The histories of the test's first frames have
/// many duplicates.
TEST(RestirPtDuplication, KeepsTheMeanWithinThreePercent) {
  const Measured truth = testing::after_moves(testing::posts(), paths(), 8, 6, 64)[0];
  RenderSettings settings = settings_of(PathCorrection::exact);
  const Measured plain = between_posts(settings);
  settings.restir_pt.duplication = 0.8f;
  const Measured capped = between_posts(settings);
  EXPECT_NE(capped.mean, plain.mean);
  EXPECT_LT(error_of(capped, truth), 0.02 * truth.mean);
  EXPECT_NEAR(capped.mean, truth.mean, 0.03 * truth.mean + 4.5 * error_of(capped, truth));
}

}  // namespace
}  // namespace relume
