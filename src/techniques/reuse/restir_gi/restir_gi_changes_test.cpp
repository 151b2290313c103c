// Tests what becomes of reservoirs when lights change, and the repetition of their paths.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_gi/testing/posts.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {
namespace {

using testing::error_of;
using testing::Measured;
using testing::reuse_settings;

RenderSettings settings_of(ReuseCorrection correction, int validate) {
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.history = HistoryChoice::none;
  settings.restir_gi.correction = correction;
  settings.restir_gi.validate = validate;
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

Measured dim_truth() {
  RenderSettings settings = reuse_settings(ReuseChoice::none);
  return after_dimming(settings, 64);
}

TEST(RestirGiLightChange, EndsReservoirsIfExact) {
  const Measured truth = dim_truth();
  const Measured first = after_dimming(settings_of(ReuseCorrection::exact, 3), 1);
  EXPECT_NEAR(first.mean, truth.mean, 6 * error_of(first, truth));
}

TEST(RestirGiLightChange, LagsWithoutValidation) {
  const Measured truth = dim_truth();
  const Measured late = after_dimming(settings_of(ReuseCorrection::lagging, 0), 3);
  EXPECT_GT(late.mean, 2 * truth.mean);
}

/// Largest luminance among the samples of the reservoirs that the next frame reuses. Samples that do not move are left
/// out: no other pixel or frame uses them.
float brightest_sample(const Session& session) {
  float most = 0;
  for (const auto& reservoir : testing::StoredReservoirs<IndirectVertex>(session, "restir-gi").reservoirs) {
    const bool moves = reservoir.weight > 0.0f && !reservoir.sample.has(IndirectVertex::kBound);
    if (moves) most = std::max(most, luminance(reservoir.sample.radiance));
  }
  return most;
}

/// All copies of a sample follow in the same frame, also those that pixels without a path keep.
TEST(RestirGiLightChange, IsFollowedByKeptReservoirs) {
  const auto brightest_after = [](float before, int validate) {
    RenderSettings settings = settings_of(ReuseCorrection::lagging, validate);
    settings.history = HistoryChoice::accumulate;
    settings.upscaling.factor = 2;
    Session session(testing::posts(), settings);
    session.set_light(0, testing::ceiling_lamp(Rgb(before)));
    for (int i = 0; i < 8; ++i) session.render_frame();
    session.set_light(0, testing::ceiling_lamp(Rgb(kDim)));
    for (int i = 0; i < 3; ++i) session.render_frame();
    return brightest_sample(session);
  };
  const float dim = brightest_after(kDim, 3);
  EXPECT_GT(dim, 0);
  EXPECT_LT(brightest_after(kBright, 3), 1.5f * dim);
  EXPECT_GT(brightest_after(kBright, 0), 1.5f * dim);
}

TEST(RestirGiLightChange, IsFollowedWithinOneIntervalOfValidation) {
  const Measured truth = dim_truth();
  for (const int interval : {1, 3}) {
    const Measured followed = after_dimming(settings_of(ReuseCorrection::lagging, interval), interval);
    EXPECT_NEAR(followed.mean, truth.mean, 0.1 * truth.mean + 6 * error_of(followed, truth)) << interval;
  }
}

struct Frames {
  Image image;
  uint64_t rays = 0;
};

Frames at_rest(const RenderSettings& settings) {
  Session session(testing::posts(), settings);
  for (int i = 0; i < 6; ++i) session.render_frame();
  return {session.image(), session.statistics().rays};
}

/// Repeated paths find the same light, bit for bit.
TEST(RestirGiValidation, ChangesNothingAtRest) {
  for (const ReuseCorrection correction : {ReuseCorrection::lagging, ReuseCorrection::basic}) {
    const Frames without = at_rest(settings_of(correction, 0));
    const Frames with = at_rest(settings_of(correction, 1));
    EXPECT_EQ(with.image.pixels, without.image.pixels);
    EXPECT_GT(with.rays, without.rays);
  }
  const Frames exact = at_rest(settings_of(ReuseCorrection::exact, 0));
  EXPECT_EQ(at_rest(settings_of(ReuseCorrection::exact, 1)).rays, exact.rays) << "needs no validation";
}

RenderSettings settings_with(CacheChoice cache, int validate) {
  RenderSettings settings = settings_of(ReuseCorrection::lagging, validate);
  settings.cache = cache;
  return settings;
}

/// Cells of primary hits do not contain the light of samples.
TEST(RestirGiValidation, ChangesNothingAtRestBesideCellsOfPrimaryHits) {
  for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf}) {
    const Frames without = at_rest(settings_with(cache, 0));
    const Frames with = at_rest(settings_with(cache, 1));
    EXPECT_EQ(with.image.pixels, without.image.pixels);
    EXPECT_GT(with.rays, without.rays);
  }
}

TEST(RestirGiValidation, LeavesOutSamplesThatEndInCells) {
  for (const CacheChoice cache : {CacheChoice::apg, CacheChoice::apsf_apg, CacheChoice::sharc})
    EXPECT_EQ(at_rest(settings_with(cache, 1)).rays, at_rest(settings_with(cache, 0)).rays);
}

/// The image after movements of the camera, each of which gives the frames another seed.
Image after_moves(int validate) {
  RenderSettings settings = settings_of(ReuseCorrection::lagging, validate);
  settings.history = HistoryChoice::accumulate;
  Session session(testing::posts(), settings);
  CameraPose pose = session.camera();
  for (int i = 0; i < 6; ++i) {
    pose.to_world[3].x += 0.01f;
    session.set_camera(pose);
    session.render_frame();
  }
  return session.image();
}

TEST(RestirGiValidation, RepeatsPathsOfEarlierSeeds) { EXPECT_EQ(after_moves(1).pixels, after_moves(0).pixels); }

}  // namespace
}  // namespace relume
