// Tests which paths the spatially hashed radiance cache traces, where they end, and that bits depend on nothing else.
#include <gtest/gtest.h>

#include <cstring>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "render/build_pipeline.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/sharc/testing/sharc_sessions.h"

namespace relume {
namespace {

using testing::closed_furnace;
using testing::sharc_settings;
using testing::skip_frames;

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

bool same_bits(const Image& a, const Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

/// Rays of `count` frames after 16 others.
double rays_of(const Scene& scene, const RenderSettings& settings, int count = 16) {
  Session session(Scene(scene), settings);
  skip_frames(session, 16);
  const uint64_t before = session.statistics().rays;
  skip_frames(session, count);
  return static_cast<double>(session.statistics().rays - before);
}

/// Expects frames to have the bits of path tracing.
void expect_bits_of_paths(const Scene& scene, RenderSettings settings) {
  Session cached(Scene(scene), settings);
  settings.cache = CacheChoice::none;
  Session paths(Scene(scene), settings);
  for (int frame = 0; frame < 6; ++frame) {
    cached.render_frame();
    paths.render_frame();
    ASSERT_TRUE(same_bits(cached.image(), paths.image())) << frame;
  }
}

TEST(Sharc, OnePixelOfEachBlockTracesAnUpdate) {
  const Scene scene = closed_furnace(0.9f);
  RenderSettings settings = sharc_settings(25, 25);
  settings.sharc.min_samples = 4096;  // no path ends in a cell
  const double sparse = rays_of(scene, settings);
  settings.sharc.update = SharcUpdate::all;
  const double all = rays_of(scene, settings);
  settings.cache = CacheChoice::none;
  const double paths = rays_of(scene, settings);
  EXPECT_GT(sparse, paths);
  // 400 update paths of 8 vertices, whose number of rays varies by a quarter.
  EXPECT_NEAR((all - paths) / (sparse - paths), 25.0, 2.0);
}

TEST(Sharc, UnknownCellsChangeNoBit) {
  RenderSettings settings = sharc_settings(32, 32);
  settings.sharc.min_samples = 4096;
  expect_bits_of_paths(build("cornell-spheres"), settings);
}

TEST(Sharc, UnknownCellsChangeNoBitOfReservoirs) {
  for (const ReuseChoice reuse :
       {ReuseChoice::ris, ReuseChoice::restir_di, ReuseChoice::restir_gi, ReuseChoice::restir_di_gi}) {
    RenderSettings settings = sharc_settings(32, 32);
    settings.sharc.min_samples = 4096;
    settings.reuse = reuse;
    expect_bits_of_paths(build("cornell-spheres"), settings);
  }
}

/// Update paths sample lights at primary hits, although camera paths leave these to reservoirs. Cells without that
/// light would darken the image.
TEST(Sharc, ReservoirsLeaveDirectLightToTheCells) {
  RenderSettings settings = sharc_settings(32, 32);
  settings.sharc.update = SharcUpdate::all;
  settings.sharc.min_samples = 1;
  const auto mean_with = [&](ReuseChoice reuse) {
    settings.reuse = reuse;
    Session session(build("cornell"), settings);
    skip_frames(session, 32);
    return testing::mean_of_frames(session, 64);
  };
  const double expected = mean_with(ReuseChoice::none);
  EXPECT_NEAR(mean_with(ReuseChoice::ris), expected, 0.03 * expected);
  settings.restir.cap = settings.restir_gi.cap = 4;
  EXPECT_NEAR(mean_with(ReuseChoice::restir_gi), expected, 0.03 * expected);
  EXPECT_NEAR(mean_with(ReuseChoice::restir_di_gi), expected, 0.03 * expected);
  settings.restir_pt.cap = 4;
  EXPECT_NEAR(mean_with(ReuseChoice::restir_pt), expected, 0.03 * expected);
}

TEST(Sharc, CellsLargerThanTheRoomChangeNoBit) {
  RenderSettings settings = sharc_settings(24, 24);
  settings.sharc.cell_size = 1024;
  settings.sharc.min_samples = 1;
  expect_bits_of_paths(closed_furnace(0.5f), settings);
}

TEST(Sharc, PathsPassSurfacesWithDeltaLobes) {
  Scene scene = build("cornell");
  for (Material& m : scene.materials) {
    m.roughness = 0;
    m.specular = 1;
    m.ior = 2.5f;
  }
  RenderSettings settings = sharc_settings(24, 24);
  settings.sharc.update = SharcUpdate::all;
  settings.sharc.min_samples = 1;
  expect_bits_of_paths(scene, settings);
}

TEST(Sharc, KnownCellsShortenPaths) {
  const Scene scene = closed_furnace(0.9f);
  RenderSettings settings = sharc_settings(24, 24);
  settings.path.max_bounces = 16;
  settings.sharc.min_samples = 1;
  const double cached = rays_of(scene, settings);
  settings.cache = CacheChoice::none;
  EXPECT_LT(cached, 0.7 * rays_of(scene, settings));
}

TEST(Sharc, LargeVarianceKeepsPathsAlive) {
  const Scene scene = closed_furnace(0.9f);
  RenderSettings settings = sharc_settings(24, 24);
  settings.path.max_bounces = 16;
  settings.sharc.update = SharcUpdate::all;
  settings.sharc.end = SharcEnd::variance;
  settings.sharc.variance = 1e6f;
  const double tolerant = rays_of(scene, settings);
  settings.sharc.variance = 0;
  const double strict = rays_of(scene, settings);
  EXPECT_GT(strict, 1.2 * tolerant);
  settings.sharc.end = SharcEnd::footprint;
  EXPECT_LE(rays_of(scene, settings), 1.01 * tolerant);
}

/// Settings with default choices, with all updates and with learned choices, for an image whose size is not a multiple
/// of blocks.
std::vector<RenderSettings> variants() {
  RenderSettings plain = sharc_settings(47, 38);
  plain.sharc.min_samples = 1;
  RenderSettings all = plain;
  all.sharc.update = SharcUpdate::all;
  RenderSettings regions = testing::with_learned_regions(plain);
  regions.history = HistoryChoice::reproject;  // records first vertices, too
  RenderSettings tiles = plain;
  tiles.lights = LightSelectionChoice::neeat;
  RenderSettings chains = testing::with_chains(plain);
  chains.reuse = ReuseChoice::restir_di;  // records first scattering events, too
  return {plain, all, regions, tiles, chains};
}

TEST(Sharc, SameBitsWithAnyNumberOfThreads) {
  for (const RenderSettings& variant : variants()) {
    const auto render = [&](int threads, bool scalar) {
      RenderSettings settings = variant;
      settings.threads = threads;
      settings.scalar_kernels = scalar;
      Session session(build("cornell-spheres"), settings);
      std::vector<Rgb> frames;
      for (int i = 0; i < 6; ++i) {
        session.render_frame();
        const Image image = session.image();
        frames.insert(frames.end(), image.pixels.begin(), image.pixels.end());
      }
      EXPECT_TRUE(session.warnings().empty());
      return std::pair(frames, session.statistics().rays);
    };
    const auto one = render(1, false);
    EXPECT_TRUE(render(5, false) == one);
    EXPECT_TRUE(render(2, true) == one) << "the device form of kernels";
  }
}

TEST(Sharc, ResumesWithTheSameBits) {
  const TempFolder folder;
  const RenderSettings plain = sharc_settings(40, 30);
  const RenderSettings learned[] = {plain, testing::with_learned_regions(plain), testing::with_chains(plain)};
  for (const RenderSettings& settings : learned) {
    Session whole(build("cornell"), settings);
    skip_frames(whole, 8);
    whole.save_checkpoint(folder / "sharc.checkpoint");
    Session resumed(build("cornell"), settings);
    resumed.load_checkpoint(folder / "sharc.checkpoint");
    for (int frame = 0; frame < 6; ++frame) {
      whole.render_frame();
      resumed.render_frame();
      ASSERT_TRUE(same_bits(whole.image(), resumed.image())) << &settings - learned << " " << frame;
    }
  }
}

/// No region learns from vertices at which paths end. In the furnace, these are nearly all second vertices.
TEST(Sharc, RegionsLearnFromVerticesBeforeCells) {
  RenderSettings settings = testing::with_learned_regions(sharc_settings(24, 24));
  settings.guide = GuideChoice::bsdf;  // every path has a second vertex
  settings.sharc.update = SharcUpdate::all;
  settings.sharc.cell_size = 2;
  const auto records_a_path = [&](int min_samples) {
    settings.sharc.min_samples = min_samples;
    Session session(closed_furnace(0.9f), settings);
    skip_frames(session, 24);
    return testing::statistic(session, "octree.samples") / (24.0 * 24.0);
  };
  EXPECT_GT(records_a_path(4096), 1.95) << "no path ends in a cell";
  EXPECT_LT(records_a_path(1), 1.4);
}

TEST(Sharc, ReportsCellsAndMemory) {
  Session session(build("cornell"), sharc_settings(40, 30));
  skip_frames(session, 4);
  EXPECT_GT(testing::statistic(session, "cells.cells"), 10);
  EXPECT_GT(testing::statistic(session, "cells.samples"), 48);  // of at most 48 update paths
  const double bytes = testing::statistic(session, "cells.bytes");
  EXPECT_GE(bytes, 132 * testing::statistic(session, "cells.slots"));
  EXPECT_GE(static_cast<double>(session.statistics().technique_bytes), bytes);
}

TEST(Sharc, RefusesLightPaths) {
  const auto reason = [](void (*change)(RenderSettings&)) {
    RenderSettings settings;
    settings.cache = CacheChoice::sharc;
    change(settings);
    return refusal(settings);
  };
  EXPECT_EQ(reason([](RenderSettings&) {}), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.lights = LightSelectionChoice::vlc; }), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.lights = LightSelectionChoice::neeat; }), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.guide = GuideChoice::cdq; }), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.lights = LightSelectionChoice::mcls; }), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.guide = GuideChoice::mcpg; }), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.reuse = ReuseChoice::restir_gi; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.estimator = EstimatorChoice::vcm; }), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.reuse = ReuseChoice::restir_pt; }), "");
}

}  // namespace
}  // namespace relume
