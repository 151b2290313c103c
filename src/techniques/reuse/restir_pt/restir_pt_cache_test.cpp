// Reservoirs of whole paths beside radiance caches: paths read cells behind their joints, and all light counts once.
#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/testing/matte_cornell.h"
#include "render/session.h"
#include "render/testing/copy_of.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_pt/stored_path.h"

namespace relume {
namespace {

using testing::copy_of;
using testing::mean_over_seeds;
using testing::Measured;
using testing::third_frame;

constexpr int kSize = 20;
constexpr size_t kPixels = size_t{kSize} * kSize;
constexpr BufferKey<PathReservoir> kReservoirs{"restir-pt-reservoirs"};

RenderSettings settings_of(CacheChoice cache, int bounces) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.path.max_bounces = bounces;
  settings.path.russian_roulette = false;
  settings.reuse = ReuseChoice::restir_pt;
  settings.restir_pt.radius = 6;
  settings.cache = cache;
  settings.psf.edge_rays = 0;
  return settings;
}

/// No cell is known.
void bypass_cells(RenderSettings& settings) { settings.psf.grid.min_count = settings.sharc.min_samples = 4096; }

bool filters_primary_hits(CacheChoice cache) { return cache == CacheChoice::psf || cache == CacheChoice::apsf; }

/// The Cornell box in grey. With coloured surfaces, the choice among the parts of a path depends on their number.
Scene grey_cornell() {
  Scene scene = testing::matte_cornell();
  for (Material& m : scene.materials) m.base_color = Rgb(0.6f);
  return scene;
}
Scene metal_cornell() { return testing::with_metal(grey_cornell()); }
Scene coated_cornell() { return testing::with_coat(grey_cornell()); }

class RestirPtWithCache : public ::testing::TestWithParam<CacheChoice> {};
INSTANTIATE_TEST_SUITE_P(Caches, RestirPtWithCache,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg,
                                           CacheChoice::sharc));

/// Without known cells, candidates find the light of plain paths.
TEST_P(RestirPtWithCache, CandidatesHaveTheLightOfPathsWithoutKnownCells) {
  for (Scene (*scene)() : {grey_cornell, metal_cornell, coated_cornell}) {
    RenderSettings settings = settings_of(GetParam(), 4);
    settings.restir_pt.cap = settings.restir_pt.neighbours = 0;
    bypass_cells(settings);
    const std::vector<PathReservoir> cached = third_frame(settings, kReservoirs, scene());
    settings.cache = CacheChoice::none;
    const std::vector<PathReservoir> plain = third_frame(settings, kReservoirs, scene());
    int lit = 0;
    for (size_t i = 0; i < kPixels; ++i) {
      const auto light = [i](const std::vector<PathReservoir>& r) {
        return r[i].weight * luminance(r[i].sample.value);
      };
      EXPECT_EQ(cached[i].confidence, plain[i].confidence) << i;
      EXPECT_NEAR(light(cached), light(plain), 1e-3f * (1e-3f + light(plain))) << i;
      lit += light(plain) > 0.0f ? 1 : 0;
    }
    EXPECT_GT(lit, 100);
  }
}

/// Caches with cells behind primary hits end paths after their joints; others hold no light of reservoirs.
TEST_P(RestirPtWithCache, OnlyLightBehindJointsComesFromCells) {
  RenderSettings settings = settings_of(GetParam(), 4);
  int cached = 0;
  for (const PathReservoir& r : third_frame(settings, kReservoirs, grey_cornell())) {
    if (!(r.weight > 0.0f)) continue;
    const StoredPath& path = r.sample;
    const bool has_vertex_behind_joint = path.joint() > 0 && path.joint() + 1 < path.length();
    EXPECT_EQ(path.end() == PathEnd::cached, has_vertex_behind_joint && !filters_primary_hits(GetParam()));
    cached += path.end() == PathEnd::cached ? 1 : 0;
  }
  EXPECT_EQ(cached > 20, !filters_primary_hits(GetParam()));
  if (GetParam() == CacheChoice::sharc) return;
  for (const FilteredPixel& p : third_frame(settings, kFilteredPixels, grey_cornell())) EXPECT_FALSE(p.filtered);
}

/// Cells replace the rest of the paths.
TEST_P(RestirPtWithCache, PathsEndInCells) {
  RenderSettings settings = settings_of(GetParam(), 8);
  settings.restir_pt.cap = settings.restir_pt.neighbours = 0;
  settings.psf.grid.min_count = settings.sharc.min_samples = 1;
  settings.sharc.cell_size = 2;
  settings.apg.variance_constant = 0;
  settings.apg.feed = 0;
  const auto rays_with = [&](CacheChoice cache) {
    settings.cache = cache;
    Session session(testing::closed_furnace(0.9f), settings);
    for (int i = 0; i < 16; ++i) session.render_frame();
    const uint64_t before = session.statistics().rays;
    session.render_frame();
    return static_cast<double>(session.statistics().rays - before);
  };
  const double plain = rays_with(CacheChoice::none);
  const double cached = rays_with(GetParam());
  if (filters_primary_hits(GetParam())) {
    EXPECT_EQ(cached, plain) << "its cells would be those of primary hits";
  } else {
    EXPECT_LT(cached, 0.8 * plain);
  }
}

class RestirPtInFurnace : public RestirPtWithCache {};
INSTANTIATE_TEST_SUITE_P(Caches, RestirPtInFurnace,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg,
                                           CacheChoice::apsf_apg));

/// Light of every bounce counts once. Cells of sharc have light of more bounces than paths.
TEST_P(RestirPtInFurnace, HasTheMean) {
  constexpr float kAlbedo = 0.5f;
  constexpr int kBounces = 4;
  constexpr int kFrames = 16;
  RenderSettings settings = settings_of(GetParam(), kBounces);
  settings.path.russian_roulette = true;
  Session session(testing::closed_furnace(kAlbedo), settings);
  const Measured mean = mean_over_seeds(8, [&](int seed) {
    session.restart(seed);
    for (int i = 0; i < kFrames; ++i) session.render_frame();
    double sum = 0;
    for (const Rgb& pixel : session.image().pixels) sum += static_cast<double>(luminance(pixel));
    return sum / static_cast<double>(kPixels);
  });
  const double expected = testing::closed_furnace_radiance(static_cast<double>(kAlbedo), kBounces);
  EXPECT_LT(mean.error, 0.003 * expected);
  EXPECT_NEAR(mean.mean, expected, 0.01 * expected + 4.5 * mean.error);
}

constexpr int kMoving = 6;
constexpr int kKept = 8;

/// Compares image and blocks with path tracing. `bias`: relative, of the cache; without it, no cell is known.
void expect_mean_of_paths(const Scene& scene, RenderSettings settings, double bias) {
  settings.width = settings.height = testing::kReuseSize;
  settings.restir_pt.cap = 8;
  if (bias == 0) bypass_cells(settings);
  const std::vector<Measured> reused = testing::after_moves(scene, settings, 20, kMoving, kKept);
  settings.cache = CacheChoice::none;
  settings.reuse = ReuseChoice::none;
  const std::vector<Measured> truth = testing::after_moves(scene, settings, 8, kMoving, 64);
  EXPECT_LT(testing::error_of(reused[0], truth[0]), 0.02 * truth[0].mean);
  for (size_t k = 0; k < (bias > 0 ? size_t{1} : truth.size()); ++k) {
    const double tolerance = bias * truth[k].mean + (k == 0 ? 6 : 7) * testing::error_of(reused[k], truth[k]) + 1e-6;
    EXPECT_NEAR(reused[k].mean, truth[k].mean, tolerance) << (k == 0 ? "image" : "block ") << k;
  }
}

class RestirPtCacheMean : public RestirPtWithCache {};
INSTANTIATE_TEST_SUITE_P(Caches, RestirPtCacheMean, ::testing::Values(CacheChoice::apg, CacheChoice::sharc));

/// Weights of reservoirs have no bias of their own, also between surfaces of different colours.
TEST_P(RestirPtCacheMean, IsThatOfPathTracingWithoutKnownCells) {
  for (const bool reciprocal : {false, true}) {
    RenderSettings settings = settings_of(GetParam(), 3);
    settings.restir_pt.reciprocal = reciprocal;
    expect_mean_of_paths(find_builtin_scene("cornell")->build(), settings, 0);
  }
}

/// Primary hits and vertices of joints on one side of glass, and cells on the other. Paths that have been dispersed
/// before their joints stay plain, and are not mixed with others.
TEST_P(RestirPtCacheMean, IsThatOfPathTracingBehindDispersiveGlass) {
  Scene scene = find_builtin_scene("cornell-spheres")->build();
  int glass = 0;
  for (Material& material : scene.materials) {
    if (!(material.transmission > 0)) continue;
    material.dispersion = 2;
    material.roughness = 0.4f;  // vertices on the glass can be joints
    ++glass;
  }
  ASSERT_GT(glass, 0);
  expect_mean_of_paths(scene, settings_of(GetParam(), 3), 0);
}

/// Paths in a mirror have joints further along.
TEST(RestirPtWithGraphs, HaveTheMeanOfPathTracingWithinTheirBias) {
  for (const char* scene : {"cornell", "cornell-mirror"})
    expect_mean_of_paths(find_builtin_scene(scene)->build(), settings_of(CacheChoice::apg, 3), 0.03);
}

}  // namespace
}  // namespace relume
