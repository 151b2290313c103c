// Images with Markov chains and radiance caches: chains learn from the light of cells, and images keep their mean.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "techniques/radiance_cache/sharc/testing/sharc_sessions.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

using testing::Measured;

constexpr CacheChoice kCaches[] = {CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg,
                                   CacheChoice::sharc};

constexpr int kSize = 32;

RenderSettings settings_of(CacheChoice cache, GuideChoice guide, LightSelectionChoice lights) {
  RenderSettings s;
  s.width = s.height = kSize;
  s.threads = 1;
  s.path.max_bounces = 3;
  s.history = HistoryChoice::none;
  s.cache = cache;
  s.guide = guide;
  s.lights = lights;
  return s;
}

/// A floor seen from above, lit by a patch of a wall outside the image. A lamp faces that patch at a distance of 40 cm.
Scene floor_beside_lit_wall() {
  SceneBuilder builder("patch");
  const Index white = builder.add_material(matte("white", Rgb(0.6f)));
  builder.add("floor", quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), white);
  builder.add("wall", quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}), white);
  builder.add("lamp", quad({0.1f, 0.7f, -1.6f}, {-0.2f, 0, 0}, {0, 0.2f, 0}),
              builder.add_material(emitter("lamp", Rgb(50))));
  builder.add_camera({0, 2.5f, 0.1f}, {0, 0, -0.2f}, 40);
  return builder.take();
}

/// Mean square of the luminance of eight frames after 24 others.
double mean_square(Session& session) {
  double sum = 0;
  for (int i = 0; i < 32; ++i) {
    session.render_frame();
    if (i < 24) continue;
    for (const Rgb& p : session.image().pixels) sum += static_cast<double>(luminance(p) * luminance(p));
  }
  return sum / (8.0 * kSize * kSize);
}

/// The second vertex of a path reflects all light. Paths that end in a cell there trace no further rays.
TEST(CachedChains, PointToTheLightOfCells) {
  const auto measure = [](float bsdf_fraction, int min_samples) {
    RenderSettings s = settings_of(CacheChoice::sharc, GuideChoice::mcpg, LightSelectionChoice::power);
    s.path.max_bounces = 2;
    s.mcpg.bsdf_fraction = bsdf_fraction;
    s.sharc.update = SharcUpdate::all;
    s.sharc.cell_size = 2;
    s.sharc.min_samples = min_samples;
    Session session(floor_beside_lit_wall(), s);
    double square = 0;
    for (int seed = 1; seed <= 4; ++seed) {
      session.restart(seed);
      square += mean_square(session) / 4;
    }
    EXPECT_GT(testing::statistic(session, "cells.cells"), 10);
    return std::pair(square, static_cast<double>(session.statistics().rays));
  };
  const auto guided = measure(0.3f, 1);
  const auto plain = measure(1, 1);
  const auto without_ends = measure(0.3f, 4096);
  EXPECT_GT(plain.first, 0);
  EXPECT_LT(guided.first, 0.75 * plain.first);
  EXPECT_LT(guided.second, 0.9 * without_ends.second) << "paths do not end in cells";
}

/// Mean luminance of 24 frames after eight others, by seeds.
Measured mean_of_frames(const Scene& scene, const RenderSettings& settings) {
  constexpr int kFrames = 24;
  Session session(Scene(scene), settings);
  return testing::mean_over_seeds(8, [&](int seed) {
    session.restart(seed);
    double sum = 0;
    for (int i = 0; i < 8 + kFrames; ++i) {
      session.render_frame();
      if (i < 8) continue;
      for (const Rgb& p : session.image().pixels) sum += static_cast<double>(luminance(p));
    }
    return sum / (double{kFrames} * kSize * kSize);
  });
}

/// Cells then hold light that directions have found, and no other.
TEST(CachedChains, KeepTheMeanWithoutNextEventEstimation) {
  constexpr int kBounces = 8;  // cells of sharc contain all
  constexpr double kBias = 0.05;
  const Scene scene = find_builtin_scene("cornell")->build();
  RenderSettings reference = settings_of(CacheChoice::none, GuideChoice::bsdf, LightSelectionChoice::power);
  reference.path.max_bounces = kBounces;
  const Measured expected = mean_of_frames(scene, reference);
  for (const CacheChoice cache : kCaches) {
    RenderSettings s = settings_of(cache, GuideChoice::mcpg, LightSelectionChoice::power);
    s.path.max_bounces = kBounces;
    s.mcpg.nee = false;
    s.sharc.update = SharcUpdate::all;  // few update paths would meet the lamp
    const Measured found = mean_of_frames(scene, s);
    EXPECT_LT(found.error, 0.1 * expected.mean) << static_cast<int>(cache);
    EXPECT_NEAR(found.mean, expected.mean, kBias * expected.mean + 6 * testing::error_of(found, expected))
        << static_cast<int>(cache);
  }
}

/// Chains of the lights that primary hits choose among candidates. With one bounce, only these are recorded. The share
/// of the light tree in a choice changes it once cells have states.
TEST(CachedChains, LearnFromResampledLights) {
  const auto pixels_of = [](CacheChoice cache, int frames, float base_fraction) {
    RenderSettings s = settings_of(cache, GuideChoice::bsdf, LightSelectionChoice::mcls);
    s.reuse = ReuseChoice::ris;
    s.path.max_bounces = 1;
    s.mcls.base_fraction = base_fraction;
    Session session(find_builtin_scene("cornell")->build(), s);
    for (int i = 0; i < frames; ++i) session.render_frame();
    return session.image().pixels;
  };
  for (const CacheChoice cache : kCaches) {
    EXPECT_EQ(pixels_of(cache, 1, 0.5f), pixels_of(cache, 1, 1.0f)) << static_cast<int>(cache);
    EXPECT_NE(pixels_of(cache, 3, 0.5f), pixels_of(cache, 3, 1.0f)) << static_cast<int>(cache);
  }
}

/// With and without samples for regions beside the chains, and with records of first vertices.
TEST(CachedChains, SameBitsWithAnyNumberOfThreads) {
  for (const CacheChoice cache : kCaches) {
    for (const bool regions : {false, true}) {
      RenderSettings s = settings_of(cache, regions ? GuideChoice::cdq : GuideChoice::mcpg, LightSelectionChoice::mcls);
      s.width = 47;
      s.height = 38;
      if (regions) s.history = HistoryChoice::reproject;
      const auto render = [&](int threads, bool scalar) {
        RenderSettings settings = s;
        settings.threads = threads;
        settings.scalar_kernels = scalar;
        Session session(find_builtin_scene("cornell-spheres")->build(), settings);
        std::vector<Rgb> frames;
        for (int i = 0; i < 5; ++i) {
          session.render_frame();
          const Image image = session.image();
          frames.insert(frames.end(), image.pixels.begin(), image.pixels.end());
        }
        EXPECT_TRUE(session.warnings().empty());
        return frames;
      };
      const std::vector<Rgb> one = render(1, false);
      EXPECT_TRUE(render(5, false) == one) << static_cast<int>(cache) << ' ' << regions;
      EXPECT_TRUE(render(2, true) == one) << static_cast<int>(cache) << ' ' << regions << ", form of devices";
    }
  }
}

}  // namespace
}  // namespace relume
