// Reservoirs for direct light with "bdpt" and "vcm" whose camera subpaths fill cells: the direct light of primary hits
// is in no cell and in no splat, and counts once.
#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "render/testing/copy_of.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "techniques/transport/path/first_scatter.h"
#include "techniques/transport/path/scatter_chances.h"

namespace relume {
namespace {

using testing::copy_of;
using testing::error_of;
using testing::mean_over_seeds;
using testing::Measured;

constexpr int kSize = 24;
constexpr size_t kPixels = size_t{kSize} * kSize;
constexpr double kStandardErrors = 4.5;
constexpr double kMostError = 0.02;  ///< largest standard error, relative

using Choices = std::tuple<EstimatorChoice, CacheChoice, ReuseChoice>;

RenderSettings settings_of(EstimatorChoice estimator, CacheChoice cache, ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.estimator = estimator;
  settings.cache = cache;
  settings.reuse = reuse;
  settings.restir.radius = 6;
  settings.apsf.min_samples = 16;
  settings.psf.edge_rays = 0;
  settings.bdpt.connection_roulette = 0;  // light subpaths are traced with one bounce, too
  return settings;
}

std::string choices_name(const ::testing::TestParamInfo<Choices>& info) {
  const auto& [estimator, cache, reuse] = info.param;
  return std::string(estimator == EstimatorChoice::bdpt ? "bdpt" : "vcm") +
         (cache == CacheChoice::psf ? "_psf" : "_apsf") + (reuse == ReuseChoice::ris ? "_ris" : "_restir_di");
}

const auto kEstimators = ::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::vcm);
const auto kCaches = ::testing::Values(CacheChoice::psf, CacheChoice::apsf);
const auto kAll = ::testing::Combine(kEstimators, kCaches, ::testing::Values(ReuseChoice::ris, ReuseChoice::restir_di));

Scene cornell() { return find_builtin_scene("cornell")->build(); }
/// Behind the mirror, reservoirs add no light, and cells hold all of it.
Scene box_with_mirror() { return find_builtin_scene("cornell-mirror")->build(); }

double mean_luminance_of(const Session& session) {
  double sum = 0;
  for (const Rgb& pixel : session.image().pixels) sum += static_cast<double>(luminance(pixel));
  return sum / static_cast<double>(kPixels);
}

/// Mean luminance of the images of the second half of `frames` frames: earlier ones fill the cells.
Measured mean_of_runs(const Scene& scene, const RenderSettings& settings, int seeds, int frames) {
  Session session(Scene(scene), settings);
  const Measured measured = mean_over_seeds(seeds, [&](int seed) {
    session.restart(seed);
    double mean = 0;
    for (int i = 0; i < frames; ++i) {
      session.render_frame();
      if (i >= frames / 2) mean += mean_luminance_of(session) / (frames - frames / 2);
    }
    return mean;
  });
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  return measured;
}

/// Mean luminance by path tracing in box_with_mirror(), rendered once per process.
const Measured& mean_of_paths() {
  static const Measured measured = [] {
    RenderSettings settings = settings_of(EstimatorChoice::path, CacheChoice::none, ReuseChoice::none);
    settings.history = HistoryChoice::none;
    return mean_of_runs(box_with_mirror(), settings, 12, 64);
  }();
  return measured;
}

/// `bias`: of the cache, relative. Merging adds some by its blur.
void expect_mean_of_paths(const RenderSettings& settings, double bias = 0.02) {
  constexpr double kBiasOfVcm = 0.01;
  const Measured& truth = mean_of_paths();
  const Measured measured = mean_of_runs(box_with_mirror(), settings, 8, 32);
  if (settings.estimator == EstimatorChoice::vcm) bias += kBiasOfVcm;
  EXPECT_LT(error_of(measured, truth), kMostError * truth.mean);
  EXPECT_NEAR(measured.mean, truth.mean, kStandardErrors * error_of(measured, truth) + bias * truth.mean);
}

class CachedLightPaths : public ::testing::TestWithParam<Choices> {
 protected:
  static RenderSettings settings() {
    return settings_of(std::get<0>(GetParam()), std::get<1>(GetParam()), std::get<2>(GetParam()));
  }
};
INSTANTIATE_TEST_SUITE_P(WithReservoirs, CachedLightPaths, kAll, choices_name);

class CachedLightPathsMean : public CachedLightPaths {
 protected:
  static void check() {
    RenderSettings each_frame = settings();
    each_frame.history = HistoryChoice::none;
    expect_mean_of_paths(each_frame);
  }
};
/// Each pair of choices. The slow tests have the other triples.
INSTANTIATE_TEST_SUITE_P(WithReservoirs, CachedLightPathsMean,
                         ::testing::Values(Choices(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::restir_di),
                                           Choices(EstimatorChoice::bdpt, CacheChoice::apsf, ReuseChoice::ris),
                                           Choices(EstimatorChoice::vcm, CacheChoice::psf, ReuseChoice::ris),
                                           Choices(EstimatorChoice::vcm, CacheChoice::apsf, ReuseChoice::restir_di)),
                         choices_name);
TEST_P(CachedLightPathsMean, IsThatOfPathTracing) { check(); }

class SlowCachedLightPathsMean : public CachedLightPathsMean {};
INSTANTIATE_TEST_SUITE_P(Slow, SlowCachedLightPathsMean,
                         ::testing::Values(Choices(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::ris),
                                           Choices(EstimatorChoice::bdpt, CacheChoice::apsf, ReuseChoice::restir_di),
                                           Choices(EstimatorChoice::vcm, CacheChoice::psf, ReuseChoice::restir_di),
                                           Choices(EstimatorChoice::vcm, CacheChoice::apsf, ReuseChoice::ris)),
                         choices_name);
TEST_P(SlowCachedLightPathsMean, IsThatOfPathTracing) { check(); }

int count_lit(const std::vector<FilteredPixel>& pixels) {
  return static_cast<int>(
      std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return !is_black(p.traced); }));
}

/// Number of pixels whose subpaths found light for a cell in the second frame.
int lit_samples(const RenderSettings& settings) {
  Session session(cornell(), settings);
  session.render_frame();
  session.render_frame();
  const std::vector<FilteredPixel> pixels = copy_of(session, kFilteredPixels);
  EXPECT_GT(std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return p.filtered; }), 100);
  return count_lit(pixels);
}

/// With one bounce, no other light exists. A large radius would let merging find it.
TEST_P(CachedLightPaths, CellsOfPrimaryHitsHoldNoDirectLight) {
  RenderSettings s = settings();
  s.path.max_bounces = 1;
  s.vcm.radius = 0.05f;
  s.apsf.survival = SurvivalFunction::one;
  EXPECT_EQ(lit_samples(s), 0);
  s.path.max_bounces = 2;
  EXPECT_GT(lit_samples(s), 50);
  s.path.max_bounces = 1;
  s.reuse = ReuseChoice::none;
  EXPECT_GT(lit_samples(s), 50);
}

/// The reservoirs are those of a pixel without a cache, except where rounding decides a choice. No splat adds light.
TEST_P(CachedLightPaths, PixelsShowTheDirectLightOfReservoirs) {
  RenderSettings s = settings();
  s.path.max_bounces = 1;
  s.apsf.survival = SurvivalFunction::one;
  Session cached(cornell(), s);
  s.cache = CacheChoice::none;
  Session plain(cornell(), s);
  for (int frame = 0; frame < 4; ++frame) {
    cached.render_frame();
    plain.render_frame();
  }
  const std::vector<Rgb> a = cached.image().pixels;
  const std::vector<Rgb> b = plain.image().pixels;
  int different = 0;
  int lit = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    different += max_component(abs(a[i] - b[i])) > 1e-3f * (1e-3f + max_component(b[i])) ? 1 : 0;
    lit += is_black(b[i]) ? 0 : 1;
  }
  EXPECT_GT(lit, 100);
  EXPECT_LE(different, 6);
}

/// Adaptive sampling keeps splats in an image of their own.
TEST_P(CachedLightPaths, SplatsAndCellsKeepTheLightOfLongerPaths) {
  RenderSettings s = settings();
  s.path.max_bounces = 3;
  s.allocation = AllocationChoice::adaptive;
  Session session(cornell(), s);
  for (int i = 0; i < 2; ++i) session.render_frame();
  const std::vector<Rgb> splats = copy_of(session, kLightRadiance);
  EXPECT_GT(std::count_if(splats.begin(), splats.end(), [](const Rgb& light) { return !is_black(light); }), 50);
  EXPECT_GT(count_lit(copy_of(session, kFilteredPixels)), 50);
}

/// Every direction meets a light, so half of the direct light comes from the directions of subpaths. Survival ends many
/// of these at the primary hit, and the others must make up for them.
TEST_P(CachedLightPaths, SubpathsThatEndInCellsKeepTheMeanOfAFurnace) {
  constexpr float kAlbedo = 0.5f;
  constexpr int kFrames = 24;
  RenderSettings s = settings();
  s.path.max_bounces = 2;
  s.ris.candidates = 1;
  Session session(testing::closed_furnace(kAlbedo), s);
  float least_chance = 1;
  const Measured mean = mean_over_seeds(8, [&](int seed) {
    session.restart(seed);
    for (int i = 0; i < kFrames; ++i) session.render_frame();
    const std::vector<float> chances = copy_of(session, kScatterChances);
    least_chance = std::min(least_chance, *std::min_element(chances.begin(), chances.end()));
    return mean_luminance_of(session);
  });
  if (s.cache == CacheChoice::psf) {
    EXPECT_EQ(least_chance, 1.0f);
  } else {
    EXPECT_LT(least_chance, 0.8f);
  }
  const double expected = testing::closed_furnace_radiance(static_cast<double>(kAlbedo), 2);
  EXPECT_LT(mean.error, 0.005 * expected);
  EXPECT_NEAR(mean.mean, expected, 0.02 * expected + kStandardErrors * mean.error);
}

class LearningCachedLightPaths : public ::testing::TestWithParam<EstimatorChoice> {
 protected:
  static RenderSettings settings() {
    RenderSettings s = settings_of(GetParam(), CacheChoice::apsf, ReuseChoice::restir_di);
    s.lights = LightSelectionChoice::vlc;
    s.guide = GuideChoice::cdq;
    s.octree = {.collapse = 32, .split = 64, .scale = false};  // many regions
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(WithReservoirs, LearningCachedLightPaths, kEstimators, [](const auto& test) {
  return std::string(test.param == EstimatorChoice::bdpt ? "bdpt" : "vcm");
});

TEST_P(LearningCachedLightPaths, HaveTheMeanOfPathTracing) {
  RenderSettings each_frame = settings();
  each_frame.history = HistoryChoice::none;
  expect_mean_of_paths(each_frame);
}

/// Reservoirs choose lights at the primary hits of all pixels, also of those whose subpaths end there.
TEST_P(LearningCachedLightPaths, KnowTheRegionsOfSubpathsThatEnd) {
  Session session(cornell(), settings());
  for (int i = 0; i < 16; ++i) session.render_frame();
  const std::vector<FilteredPixel> pixels = copy_of(session, kFilteredPixels);
  const std::vector<FirstScatter> scatters = copy_of(session, kFirstScatters);
  int ended = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    if (!pixels[i].culled) continue;
    ++ended;
    EXPECT_NE(scatters[i].region, kNoRegion) << i;
  }
  EXPECT_GT(ended, 10);
}

}  // namespace
}  // namespace relume
