// Reservoirs of indirect light beside radiance caches: paths of samples read cells behind primary hits, and their light
// counts once.
#include <algorithm>
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
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

using testing::copy_of;
using testing::matte_cornell;
using testing::mean_over_seeds;
using testing::Measured;
using testing::third_frame;

constexpr int kSize = 20;
constexpr size_t kPixels = size_t{kSize} * kSize;

RenderSettings settings_of(ReuseChoice reuse, CacheChoice cache, int bounces) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.path.max_bounces = bounces;
  settings.path.russian_roulette = false;
  settings.reuse = reuse;
  settings.restir.radius = settings.restir_gi.radius = 6;
  settings.cache = cache;
  settings.psf.edge_rays = 0;
  return settings;
}

Scene metal_cornell() { return testing::with_metal(matte_cornell()); }
Scene coated_cornell() { return testing::with_coat(matte_cornell()); }

bool near(const Rgb& a, const Rgb& b) { return max_component(abs(a - b)) <= 1e-3f * (1e-3f + max_component(b)); }

class RestirGiWithCache : public ::testing::TestWithParam<CacheChoice> {};
INSTANTIATE_TEST_SUITE_P(Caches, RestirGiWithCache,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg,
                                           CacheChoice::sharc));

/// Compares samples, and returns the number of samples with light.
int expect_samples(const std::vector<IndirectSample>& cached, const std::vector<IndirectSample>& plain) {
  int lit = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    const IndirectSample& a = cached[i];
    const IndirectSample& b = plain[i];
    EXPECT_EQ(a.vertex.instance, b.vertex.instance) << i;
    EXPECT_EQ(a.vertex.primitive, b.vertex.primitive) << i;
    EXPECT_NEAR(a.weight, b.weight, 1e-3f * b.weight) << i;
    EXPECT_TRUE(near(a.vertex.radiance, b.vertex.radiance)) << i;
    lit += is_black(b.vertex.radiance) ? 0 : 1;
  }
  return lit;
}

/// Vertices, densities and light are those of paths, in units that depend on no primary hit. Primary hits on metal have
/// no cells; the vertices behind them have none, either, in caches that filter the first possible vertex.
TEST_P(RestirGiWithCache, SamplesAreThoseOfPathsWithoutKnownCells) {
  for (Scene (*scene)() : {matte_cornell, metal_cornell, coated_cornell}) {
    RenderSettings settings = settings_of(ReuseChoice::restir_gi, GetParam(), 3);
    settings.psf.grid.min_count = settings.sharc.min_samples = 4096;
    const std::vector<IndirectSample> cached = third_frame(settings, kIndirectSamples, scene());
    settings.cache = CacheChoice::none;
    const std::vector<IndirectSample> plain = third_frame(settings, kIndirectSamples, scene());
    EXPECT_GT(expect_samples(cached, plain), 100);
  }
}

/// They have direct light alone, or nothing if other reservoirs add that, too.
TEST(RestirGiWithFilter, CellsOfPrimaryHitsLackTheLightOfReservoirs) {
  for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf}) {
    const auto with_both =
        third_frame(settings_of(ReuseChoice::restir_di_gi, cache, 4), kFilteredPixels, matte_cornell());
    const auto with_indirect =
        third_frame(settings_of(ReuseChoice::restir_gi, cache, 4), kFilteredPixels, matte_cornell());
    RenderSettings direct = settings_of(ReuseChoice::none, cache, 1);
    direct.apsf.survival = SurvivalFunction::one;
    const auto only_direct = third_frame(direct, kFilteredPixels, matte_cornell());
    int lit = 0;
    for (size_t i = 0; i < kPixels; ++i) {
      EXPECT_TRUE(is_black(with_both[i].traced)) << i;
      EXPECT_EQ(with_indirect[i].filtered, only_direct[i].filtered) << i;
      EXPECT_TRUE(near(with_indirect[i].traced, only_direct[i].traced)) << i;
      lit += is_black(only_direct[i].traced) ? 0 : 1;
    }
    EXPECT_GT(lit, 100);
  }
}

/// A pixel shows the mean of its cell, which contains the direct light of other pixels and frames.
TEST(RestirGiWithFilter, PixelsLookUpTheirCells) {
  for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf}) {
    RenderSettings settings = settings_of(ReuseChoice::restir_gi, cache, 4);
    settings.history = HistoryChoice::reproject;  // keeps the light of cells apart
    const auto pixels = third_frame(settings, kFilteredPixels, matte_cornell());
    const auto shown = third_frame(settings, kRadianceCells, matte_cornell());
    int looked_up = 0;
    for (size_t i = 0; i < kPixels; ++i) looked_up += pixels[i].filtered && !near(shown[i], pixels[i].traced) ? 1 : 0;
    EXPECT_GT(looked_up, 100);
  }
}

/// Cells of direct light do not tell whether reservoirs need the path. Whether the pixel shows them remains a choice.
TEST(RestirGiWithFilter, EveryPathSurvivesWithAnyBlend) {
  for (const BlendFunction blend : {BlendFunction::zero, BlendFunction::one}) {
    RenderSettings settings = settings_of(ReuseChoice::restir_gi, CacheChoice::apsf, 4);
    settings.psf.grid.min_count = settings.apsf.min_samples = 1;
    settings.apsf.blend = blend;
    const auto culled = [&] {
      const auto pixels = third_frame(settings, kFilteredPixels, matte_cornell());
      return std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return p.culled; });
    };
    for (const FilteredPixel& p : third_frame(settings, kFilteredPixels, matte_cornell())) {
      if (!p.filtered) continue;
      EXPECT_EQ(p.survival, 1.0f);
      EXPECT_EQ(p.blend, blend == BlendFunction::zero ? 0.0f : 1.0f);
    }
    EXPECT_EQ(culled(), 0);
    settings.reuse = ReuseChoice::none;
    EXPECT_GT(culled(), 0);
  }
}

/// Cells replace the rest of the paths of samples, and pixels show no cell. The caches that filter primary hits do the
/// opposite: no sample looks up a cell, and pixels do (PixelsLookUpTheirCells).
TEST_P(RestirGiWithCache, SamplesEndInCells) {
  const bool filters = GetParam() == CacheChoice::psf || GetParam() == CacheChoice::apsf;
  RenderSettings settings = settings_of(ReuseChoice::restir_gi, GetParam(), 8);
  settings.restir_gi.cap = settings.restir_gi.neighbours = 0;
  settings.psf.grid.min_count = settings.sharc.min_samples = 1;
  settings.apg.variance_constant = 0;
  settings.apg.feed = 0;
  const auto rays_with = [&](CacheChoice cache) {
    settings.cache = cache;
    Session session(testing::closed_furnace(0.9f), settings);
    for (int i = 0; i < 16; ++i) session.render_frame();
    const uint64_t before = session.statistics().rays;
    session.render_frame();
    if (cache == CacheChoice::apg || cache == CacheChoice::apsf_apg) {
      const std::vector<FilteredPixel> pixels = copy_of(session, kFilteredPixels);
      EXPECT_TRUE(std::none_of(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return p.filtered; }));
    }
    return static_cast<double>(session.statistics().rays - before);
  };
  const double plain = rays_with(CacheChoice::none);
  const double cached = rays_with(GetParam());
  if (filters) {
    EXPECT_EQ(cached, plain) << "reservoirs take the light of later vertices, so none is filtered";
  } else {
    EXPECT_LT(cached, 0.8 * plain);
  }
}

class RestirGiInFurnace : public ::testing::TestWithParam<std::tuple<ReuseChoice, CacheChoice>> {};
INSTANTIATE_TEST_SUITE_P(Caches, RestirGiInFurnace,
                         ::testing::Combine(::testing::Values(ReuseChoice::restir_gi, ReuseChoice::restir_di_gi),
                                            ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg,
                                                              CacheChoice::apsf_apg)));

/// Light of every bounce counts once. Cells of sharc have light of more bounces than paths.
TEST_P(RestirGiInFurnace, HasTheMean) {
  constexpr float kAlbedo = 0.5f;
  constexpr int kBounces = 3;
  constexpr int kFrames = 16;
  const auto [reuse, cache] = GetParam();
  RenderSettings settings = settings_of(reuse, cache, kBounces);
  settings.apsf.min_samples = 8;
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

}  // namespace
}  // namespace relume
