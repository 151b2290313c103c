// Reservoirs of indirect light with "bdpt" and "vcm" whose camera subpaths fill cells: samples are those without a
// cache, cells hold the rest that camera subpaths find, and light counts once.
#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/testing/matte_cornell.h"
#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "render/testing/copy_of.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/transport/path/indirect_sample.h"
#include "techniques/transport/path/scatter_chances.h"

namespace relume {
namespace {

using testing::copy_of;
using testing::error_of;
using testing::FewerPaths;
using testing::matte_cornell;
using testing::mean_over_seeds;
using testing::Measured;
using testing::third_frame;

constexpr int kSize = testing::kReuseSize;
constexpr size_t kPixels = size_t{kSize} * kSize;

using Choices = std::tuple<EstimatorChoice, CacheChoice, ReuseChoice>;

RenderSettings settings_of(EstimatorChoice estimator, CacheChoice cache, ReuseChoice reuse) {
  RenderSettings settings = testing::reuse_settings(reuse);
  settings.estimator = estimator;
  settings.cache = cache;
  settings.restir.radius = 6;
  settings.restir.cap = settings.restir_gi.cap = 8;
  settings.path.max_bounces = 5;
  settings.apsf.min_samples = 16;
  settings.psf.edge_rays = 0;
  return settings;
}

std::string choices_name(const ::testing::TestParamInfo<Choices>& info) {
  const auto& [estimator, cache, reuse] = info.param;
  return std::string(estimator == EstimatorChoice::bdpt ? "bdpt" : "vcm") +
         (cache == CacheChoice::psf ? "_psf" : "_apsf") + (reuse == ReuseChoice::restir_gi ? "_gi" : "_di_gi");
}

Scene metal_cornell() { return testing::with_metal(matte_cornell()); }
Scene coated_cornell() { return testing::with_coat(matte_cornell()); }

/// Settings whose subpaths do not depend on rounding or on earlier frames. Light subpaths are traced with one bounce,
/// too.
RenderSettings plain_settings(const Choices& choices, int bounces) {
  RenderSettings settings = settings_of(std::get<0>(choices), std::get<1>(choices), std::get<2>(choices));
  settings.path.max_bounces = bounces;
  settings.path.russian_roulette = false;
  settings.bdpt.connection_roulette = 0;
  settings.vcm.radius = 0.02f;
  settings.history = HistoryChoice::none;
  return settings;
}

bool near(const Rgb& a, const Rgb& b) { return max_component(abs(a - b)) <= 1e-3f * (1e-3f + max_component(b)); }

class CachedLightSubpaths : public ::testing::TestWithParam<Choices> {};
INSTANTIATE_TEST_SUITE_P(RestirGi, CachedLightSubpaths,
                         ::testing::Combine(::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::vcm),
                                            ::testing::Values(CacheChoice::psf, CacheChoice::apsf),
                                            ::testing::Values(ReuseChoice::restir_gi, ReuseChoice::restir_di_gi)),
                         choices_name);

/// Vertices, densities and light of samples have units and weights that depend on no cell.
TEST_P(CachedLightSubpaths, SampleTheLightOfSubpathsWithoutCells) {
  for (Scene (*scene)() : {matte_cornell, metal_cornell, coated_cornell}) {
    RenderSettings settings = plain_settings(GetParam(), 4);
    const std::vector<IndirectSample> cached = third_frame(settings, kIndirectSamples, scene());
    settings.cache = CacheChoice::none;
    const std::vector<IndirectSample> plain = third_frame(settings, kIndirectSamples, scene());
    int lit = 0;
    for (size_t i = 0; i < kPixels; ++i) {
      const IndirectSample& a = cached[i];
      const IndirectSample& b = plain[i];
      EXPECT_EQ(a.vertex.instance, b.vertex.instance) << i;
      EXPECT_EQ(a.vertex.primitive, b.vertex.primitive) << i;
      EXPECT_EQ(a.vertex.traits, b.vertex.traits) << i;
      EXPECT_NEAR(a.weight, b.weight, 1e-3f * b.weight) << i;
      EXPECT_TRUE(near(a.vertex.radiance, b.vertex.radiance)) << i;
      lit += is_black(b.vertex.radiance) ? 0 : 1;
    }
    EXPECT_GT(lit, 100);
  }
}

/// Without delta lobes, cells have direct light alone, or nothing if other reservoirs add that, too.
TEST_P(CachedLightSubpaths, FillCellsWithoutTheLightOfReservoirs) {
  const bool takes_direct = std::get<2>(GetParam()) == ReuseChoice::restir_di_gi;
  const RenderSettings settings = plain_settings(GetParam(), 4);
  RenderSettings direct = plain_settings(GetParam(), 1);
  direct.reuse = ReuseChoice::none;
  direct.apsf.survival = SurvivalFunction::one;
  const std::vector<FilteredPixel> cached = third_frame(settings, kFilteredPixels, matte_cornell());
  const std::vector<FilteredPixel> only_direct = third_frame(direct, kFilteredPixels, matte_cornell());
  int lit = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    EXPECT_EQ(cached[i].filtered, only_direct[i].filtered) << i;
    EXPECT_TRUE(near(cached[i].traced, takes_direct ? Rgb(0) : only_direct[i].traced)) << i;
    lit += is_black(only_direct[i].traced) ? 0 : 1;
  }
  EXPECT_GT(lit, 100);
}

/// Cells without the light of reservoirs do not show whether these need the subpath.
TEST_P(CachedLightSubpaths, SurviveAtPrimaryHits) {
  RenderSettings settings = settings_of(std::get<0>(GetParam()), std::get<1>(GetParam()), std::get<2>(GetParam()));
  settings.psf.grid.min_count = settings.apsf.min_samples = 1;
  const auto count_culled = [&] {
    const std::vector<FilteredPixel> pixels = third_frame(settings, kFilteredPixels, matte_cornell());
    return std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return p.culled; });
  };
  EXPECT_EQ(count_culled(), 0);
  if (std::get<2>(GetParam()) == ReuseChoice::restir_di_gi) {
    for (const float chance : third_frame(settings, kScatterChances, matte_cornell())) EXPECT_EQ(chance, 1.0f);
  }
  if (std::get<1>(GetParam()) == CacheChoice::psf) return;
  settings.reuse = ReuseChoice::none;
  EXPECT_GT(count_culled(), 0);
}

/// Light of every bounce counts once.
TEST_P(CachedLightSubpaths, HaveTheMeanOfAFurnace) {
  constexpr float kAlbedo = 0.5f;
  constexpr int kBounces = 3;
  constexpr int kFrames = 16;
  const auto [estimator, cache, reuse] = GetParam();
  RenderSettings settings = settings_of(estimator, cache, reuse);
  settings.path.max_bounces = kBounces;
  Session session(testing::closed_furnace(kAlbedo), settings);
  const Measured mean = mean_over_seeds(8, [&](int seed) {
    session.restart(seed);
    for (int i = 0; i < kFrames; ++i) session.render_frame();
    return testing::means_of(session.image())[0];
  });
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  const double expected = testing::closed_furnace_radiance(static_cast<double>(kAlbedo), kBounces);
  EXPECT_LT(mean.error, 0.005 * expected);
  EXPECT_NEAR(mean.mean, expected, 0.02 * expected + 4.5 * mean.error);
}

/// Number of samples for cells with light, in eight frames of the coated box.
std::ptrdiff_t lit_samples(EstimatorChoice estimator, int bounces) {
  Session session(coated_cornell(), plain_settings({estimator, CacheChoice::psf, ReuseChoice::restir_di_gi}, bounces));
  std::ptrdiff_t lit = 0;
  for (int frame = 0; frame < 8; ++frame) {
    session.render_frame();
    const std::vector<FilteredPixel> pixels = copy_of(session, kFilteredPixels);
    lit += std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return !is_black(p.traced); });
  }
  return lit;
}

/// No reservoir has light that second vertices scatter by delta lobes. With one bounce, there is no such light.
TEST(CellsBesideSamplesOfSubpaths, HoldLightOfDeltaLobes) {
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    EXPECT_EQ(lit_samples(estimator, 1), 0);
    EXPECT_GT(lit_samples(estimator, 4), 40);
  }
}

constexpr int kMoving = 6;
constexpr int kKept = 8;
constexpr int kSeeds = 20;
constexpr double kMostError = 0.03;  ///< largest standard error, relative

/// Mean by path tracing, after the same movements of the camera.
Measured mean_of_paths(const Scene& scene) {
  RenderSettings settings = settings_of(EstimatorChoice::path, CacheChoice::none, ReuseChoice::none);
  return testing::after_moves(scene, settings, 24, kMoving, 96)[0];
}

/// Rendered once per process. Behind its mirrors, reservoirs add no light, and cells hold all of it.
const Measured& mean_of_mirrors() {
  static const Measured measured = mean_of_paths(find_builtin_scene("cornell-mirror")->build());
  return measured;
}

void expect_mean(const Scene& scene, const RenderSettings& settings, const Measured& truth, int seeds = kSeeds,
                 int kept = kKept) {
  constexpr double kBiasOfCells = 0.02;
  constexpr double kBiasOfVcm = 0.01;  // blur over the merging radius
  const Measured measured = testing::after_moves(scene, settings, seeds, kMoving, kept)[0];
  const double bias = kBiasOfCells + (settings.estimator == EstimatorChoice::vcm ? kBiasOfVcm : 0);
  EXPECT_LT(error_of(measured, truth), kMostError * truth.mean);
  EXPECT_NEAR(measured.mean, truth.mean, 5 * error_of(measured, truth) + bias * truth.mean);
}

void expect_mean_of_mirrors(const RenderSettings& settings, int seeds = kSeeds, int kept = kKept) {
  expect_mean(find_builtin_scene("cornell-mirror")->build(), settings, mean_of_mirrors(), seeds, kept);
}

class CachedLightSubpathsMean : public ::testing::TestWithParam<Choices> {
 protected:
  static void check() {
    const auto [estimator, cache, reuse] = GetParam();
    expect_mean_of_mirrors(settings_of(estimator, cache, reuse));
  }
};
/// Each pair of choices. The slow tests have the other triples.
INSTANTIATE_TEST_SUITE_P(RestirGi, CachedLightSubpathsMean,
                         ::testing::Values(Choices(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::restir_gi),
                                           Choices(EstimatorChoice::bdpt, CacheChoice::apsf, ReuseChoice::restir_di_gi),
                                           Choices(EstimatorChoice::vcm, CacheChoice::psf, ReuseChoice::restir_di_gi),
                                           Choices(EstimatorChoice::vcm, CacheChoice::apsf, ReuseChoice::restir_gi)),
                         choices_name);
TEST_P(CachedLightSubpathsMean, IsThatOfPathTracing) { check(); }

class SlowCachedLightSubpathsMean : public CachedLightSubpathsMean {};
INSTANTIATE_TEST_SUITE_P(Slow, SlowCachedLightSubpathsMean,
                         ::testing::Values(Choices(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::restir_di_gi),
                                           Choices(EstimatorChoice::bdpt, CacheChoice::apsf, ReuseChoice::restir_gi),
                                           Choices(EstimatorChoice::vcm, CacheChoice::psf, ReuseChoice::restir_gi),
                                           Choices(EstimatorChoice::vcm, CacheChoice::apsf, ReuseChoice::restir_di_gi)),
                         choices_name);
TEST_P(SlowCachedLightSubpathsMean, IsThatOfPathTracing) { check(); }

/// Cells, splats and samples share the light below the coats.
TEST(CachedLightSubpathsOnCoats, HaveTheMeanOfPathTracing) {
  const Scene scene = coated_cornell();
  expect_mean(scene, settings_of(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::restir_di_gi),
              mean_of_paths(scene));
}

class LearningCachedLightSubpaths : public ::testing::TestWithParam<EstimatorChoice> {};
INSTANTIATE_TEST_SUITE_P(RestirGi, LearningCachedLightSubpaths,
                         ::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::vcm), [](const auto& test) {
                           return std::string(test.param == EstimatorChoice::bdpt ? "bdpt" : "vcm");
                         });

TEST_P(LearningCachedLightSubpaths, HaveTheMeanOfPathTracing) {
  RenderSettings settings = settings_of(GetParam(), CacheChoice::apsf, ReuseChoice::restir_di_gi);
  settings.lights = LightSelectionChoice::vlc;
  settings.guide = GuideChoice::cdq;
  expect_mean_of_mirrors(settings);
}

TEST_P(LearningCachedLightSubpaths, HaveTheMeanOfPathTracingWithMarkovChains) {
  RenderSettings settings = settings_of(GetParam(), CacheChoice::psf, ReuseChoice::restir_gi);
  settings.lights = LightSelectionChoice::mcls;
  settings.guide = GuideChoice::mcpg;
  expect_mean_of_mirrors(settings);
}

TEST(CachedLightSubpathsWithFewerPaths, HaveTheMeanOfPathTracing) {
  RenderSettings settings = settings_of(EstimatorChoice::bdpt, CacheChoice::apsf, ReuseChoice::restir_gi);
  testing::apply(FewerPaths::upscaled, settings);
  expect_mean_of_mirrors(settings, 24, 24);
}

}  // namespace
}  // namespace relume
