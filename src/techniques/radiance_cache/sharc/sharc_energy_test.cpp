// Tests the energy in cells of the spatially hashed radiance cache, in scenes with known light.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/sharc/testing/sharc_sessions.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

using testing::closed_furnace;
using testing::mean_of_frames;
using testing::Measured;
using testing::sharc_settings;
using testing::skip_frames;

/// Settings for a closed furnace. Each cell is known after its first sample.
RenderSettings furnace_settings(int frames) {
  RenderSettings settings = sharc_settings(24, 24);
  settings.path.max_bounces = 16;
  settings.sharc.frames = frames;
  settings.sharc.min_samples = 1;
  settings.sharc.max_age = 16;
  return settings;
}

TEST(SharcFurnace, AlbedoOfNineTenthsHasAllBounces) {
  Session session(closed_furnace(0.9f), furnace_settings(8));
  // Nine tenths of an error return by feedback, within about seven times the averaged frames.
  skip_frames(session, 600);
  const double expected = 1 / (1 - 0.9);
  // An error of 0.3 % per bounce would exceed this.
  EXPECT_NEAR(mean_of_frames(session, 400) / expected, 1.0, 0.02);
}

TEST(SharcFurnace, LostFeedbackIsDark) {
  RenderSettings settings = furnace_settings(8);
  settings.sharc.feedback = false;
  Session session(closed_furnace(0.9f), settings);
  skip_frames(session, 50);
  EXPECT_LT(mean_of_frames(session, 50), 0.7 / (1 - 0.9));
}

/// Without feedback, cells hold `propagation-depth` bounces. A path that ends at its second vertex has two more: the
/// emission that it sees, and the direct light of the first vertex.
TEST(SharcFurnace, WithoutFeedbackThePropagationDepthCountsBounces) {
  constexpr double kAlbedo = 0.8;
  for (const int depth : {2, 4}) {
    RenderSettings settings = furnace_settings(64);
    settings.sharc.update = SharcUpdate::all;
    settings.sharc.feedback = false;
    settings.sharc.propagation_depth = depth;
    settings.sharc.cell_size = 2;
    settings.sharc.jitter = false;
    settings.sharc.max_age = 64;
    Session session(closed_furnace(static_cast<float>(kAlbedo)), settings);
    skip_frames(session, 40);
    const double expected = testing::closed_furnace_radiance(kAlbedo, depth + 1);
    // Up to 1 % more, because the guards let one path in twenty pass its second vertex. A bounce more or less is 8 %.
    EXPECT_NEAR(mean_of_frames(session, 40) / expected, 1.005, 0.02) << depth;
  }
}

/// Mean luminance of `frames` frames after `skipped` others, over seeds.
Measured over_seeds(const Scene& scene, const RenderSettings& settings, int seeds, int skipped, int frames) {
  Session session(Scene(scene), settings);
  return testing::mean_over_seeds(seeds, [&](int seed) {
    session.restart(seed);
    skip_frames(session, skipped);
    return mean_of_frames(session, frames);
  });
}

/// `variants`: settings of one image size, with the cache. `skipped`: frames in which the cells learn. `frames`:
/// number of frames compared. `most_error`: limit of the comparison's standard error.
void expect_mean_of_paths(const char* name, const std::vector<RenderSettings>& variants, int skipped, int frames,
                          double bias, double most_error) {
  constexpr int kSeeds = 6;
  const Scene scene = find_builtin_scene(name)->build();
  RenderSettings reference = sharc_settings(variants.front().width, variants.front().height);
  reference.path.max_bounces = 32;
  reference.cache = CacheChoice::none;
  reference.estimator = EstimatorChoice::bdpt;  // the same mean, with less noise
  const Measured paths = over_seeds(scene, reference, kSeeds, 0, frames + frames / 2);
  for (size_t i = 0; i < variants.size(); ++i) {
    RenderSettings settings = variants[i];
    settings.path.max_bounces = reference.path.max_bounces;
    const Measured cached = over_seeds(scene, settings, kSeeds, skipped, frames);
    const double error = std::hypot(cached.error, paths.error) / paths.mean;
    ASSERT_LT(error, most_error) << name << ", variant " << i << ": too much noise for a comparison";
    EXPECT_NEAR(cached.mean / paths.mean, 1.0, bias + 4.5 * error) << name << ", variant " << i;
  }
}

/// The mean stays the same if paths learn which lights and directions to choose.
TEST(SharcEnergy, CornellHasTheMeanOfPaths) {
  const RenderSettings plain = sharc_settings(32, 32);
  RenderSettings tiles = plain;
  tiles.lights = LightSelectionChoice::neeat;
  expect_mean_of_paths("cornell", {plain, testing::with_learned_regions(plain), tiles, testing::with_chains(plain)}, 48,
                       64, 0.03, 0.015);
}

/// Light takes many bounces, and a few bright samples decide the mean. The test fails if 60 % of the light are lost:
/// without feedback, or if samples lack the light of late vertices, more is.
TEST(SharcEnergy, TheCorridorHasTheMeanOfPaths) {
  RenderSettings settings = sharc_settings(32, 18);
  settings.sharc.update = SharcUpdate::all;
  settings.sharc.cell_size = 1;
  settings.sharc.frames = 8;
  expect_mean_of_paths("corridor", {settings}, 96, 48, 0.06, 0.12);
}

/// Mean luminance of images after `frames` frames, and as many after a move of the camera.
Measured after_moves(const Scene& scene, const RenderSettings& settings, int seeds, int frames) {
  Session session(Scene(scene), settings);
  const CameraPose end = session.camera();
  CameraPose start = end;
  start.to_world[3] -= 0.1f * start.to_world[0];
  return testing::mean_over_seeds(seeds, [&](int seed) {
    session.set_camera(start);
    session.restart(seed);
    skip_frames(session, frames);
    session.set_camera(end);
    skip_frames(session, frames);
    return testing::mean_luminance(session.image());
  });
}

/// On surfaces whose reflection depends on the view, with and without reservoirs at primary hits.
TEST(SlowSharcEnergy, ForwardReprojectionKeepsTheMeanUnderAMovingCamera) {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    m.roughness = 0.5f;
    m.specular = 0.5f;
  }
  RenderSettings settings = sharc_settings(32, 32);
  settings.path.max_bounces = 32;  // cells have light of any number of bounces
  RenderSettings reference = settings;
  reference.cache = CacheChoice::none;
  reference.estimator = EstimatorChoice::bdpt;
  const Measured paths = over_seeds(scene, reference, 8, 0, 48);
  settings.history = HistoryChoice::reproject;
  settings.reproject.stored = StoredSampleChoice::one;
  settings.reproject.max_distance = 0.1f;  // a pixel covers 2 % of its depth
  for (const ReuseChoice reuse : {ReuseChoice::none, ReuseChoice::ris, ReuseChoice::restir_di}) {
    settings.reuse = reuse;
    const Measured cached = after_moves(scene, settings, 32, 8);
    const double error = std::hypot(cached.error, paths.error) / paths.mean;
    ASSERT_LT(error, 0.01) << static_cast<int>(reuse);
    // 3 % of the cache, 2 % of the reprojection.
    EXPECT_NEAR(cached.mean / paths.mean, 1.0, 0.05 + 4.5 * error) << static_cast<int>(reuse);
  }
}

TEST(SharcEnergy, ALightSwitchedOffDecays) {
  constexpr int kFrames = 8;
  Session session(closed_furnace(0.5f), furnace_settings(kFrames));
  skip_frames(session, 64);
  const double before = mean_of_frames(session, 16);
  EXPECT_NEAR(before, 2.0, 0.06);
  session.set_material(MaterialHandle(0), testing::matte(Rgb(0.5f)));
  session.render_frame();
  const double lag = testing::mean_luminance(session.image());
  EXPECT_LT(lag, 0.3 * before) << "emission and direct light do not lag";
  EXPECT_GT(lag, 0.05 * before) << "cells of earlier frames";
  skip_frames(session, 8 * kFrames);
  EXPECT_LT(mean_of_frames(session, 8), 0.02 * before);
}

TEST(SharcEnergy, PoisonedCellsRecover) {
  Scene scene = closed_furnace(0.5f);
  const Material wall = scene.materials[0];
  Material bright = wall;
  bright.emission = Rgb(1000);
  Session session(std::move(scene), furnace_settings(4));
  session.set_material(MaterialHandle(0), bright);
  skip_frames(session, 16);
  session.set_material(MaterialHandle(0), wall);
  session.render_frame();
  EXPECT_GT(testing::mean_luminance(session.image()), 20) << "the cells are not poisoned";
  skip_frames(session, 300);
  EXPECT_NEAR(mean_of_frames(session, 100), 2.0, 0.03);
}

TEST(SharcEnergy, ATooSmallTableDegradesToPathTracing) {
  RenderSettings settings = furnace_settings(32);
  settings.sharc.max_cells = 16;
  Session session(closed_furnace(0.5f), settings);
  skip_frames(session, 20);
  EXPECT_NEAR(mean_of_frames(session, 60), 2.0, 0.04);
  const std::vector<std::string> warnings = session.warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("sharc.max-cells"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace relume
