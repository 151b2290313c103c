// Reservoirs beside radiance caches whose cells hold the light of primary hits: the direct light is in no such cell,
// and counts once.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "render/testing/copy_of.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "techniques/transport/path/scatter_chances.h"

namespace relume {
namespace {

using testing::copy_of;
using testing::mean_over_seeds;
using testing::Measured;

constexpr int kSize = 20;
constexpr size_t kPixels = size_t{kSize} * kSize;

RenderSettings settings_of(ReuseChoice reuse, CacheChoice cache) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.path.max_bounces = 1;
  settings.reuse = reuse;
  settings.restir.radius = 6;
  settings.cache = cache;
  settings.psf.edge_rays = 0;
  return settings;
}

Scene cornell() { return find_builtin_scene("cornell")->build(); }

/// Number of pixels whose paths found light for a cell in the second frame.
int lit_samples(const RenderSettings& settings) {
  Session session(cornell(), settings);
  session.render_frame();
  session.render_frame();
  const std::vector<FilteredPixel> pixels = copy_of(session, kFilteredPixels);
  EXPECT_GT(std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return p.filtered; }), 100);
  return static_cast<int>(
      std::count_if(pixels.begin(), pixels.end(), [](const FilteredPixel& p) { return !is_black(p.traced); }));
}

class RestirWithCache : public ::testing::TestWithParam<CacheChoice> {};

/// With one bounce, a path finds no other light.
TEST_P(RestirWithCache, CellsOfPrimaryHitsHoldNoDirectLight) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di, GetParam());
  settings.apsf.survival = SurvivalFunction::one;
  EXPECT_EQ(lit_samples(settings), 0);
  settings.path.max_bounces = 2;
  EXPECT_GT(lit_samples(settings), 50);
  settings = settings_of(ReuseChoice::none, GetParam());
  settings.apsf.survival = SurvivalFunction::one;
  EXPECT_GT(lit_samples(settings), 50);
}

/// The reservoirs are those of a pixel without a cache, except where rounding decides a choice.
TEST_P(RestirWithCache, PixelsShowTheDirectLightOfReservoirs) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di, GetParam());
  settings.apsf.survival = SurvivalFunction::one;
  Session cached(cornell(), settings);
  settings.cache = CacheChoice::none;
  Session plain(cornell(), settings);
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
  EXPECT_LE(different, 4);
}

/// Every direction meets a light, so half of the direct light comes from the directions of paths. Caches end most of
/// these paths at the primary hit, and the others must make up for them.
TEST_P(RestirWithCache, PathsThatEndInCellsKeepTheMeanOfAFurnace) {
  constexpr float kAlbedo = 0.5f;
  constexpr int kFrames = 24;
  RenderSettings settings = settings_of(ReuseChoice::restir_di, GetParam());
  settings.path.max_bounces = 2;
  settings.ris.candidates = 1;
  settings.apsf.min_samples = 8;
  settings.apg.variance_constant = 0;  // only the share apg.feed of the paths continues
  Session session(testing::closed_furnace(kAlbedo), settings);
  float least_chance = 1;
  const Measured mean = mean_over_seeds(8, [&](int seed) {
    session.restart(seed);
    for (int i = 0; i < kFrames; ++i) session.render_frame();
    const std::vector<float> chances = copy_of(session, kScatterChances);
    least_chance = std::min(least_chance, *std::min_element(chances.begin(), chances.end()));
    double sum = 0;
    for (const Rgb& pixel : session.image().pixels) sum += static_cast<double>(luminance(pixel));
    return sum / static_cast<double>(kPixels);
  });
  if (GetParam() == CacheChoice::psf) {
    EXPECT_EQ(least_chance, 1.0f);
  } else {
    EXPECT_LT(least_chance, 0.6f);
  }
  const double expected = testing::closed_furnace_radiance(static_cast<double>(kAlbedo), 2);
  EXPECT_LT(mean.error, 0.005 * expected);
  EXPECT_NEAR(mean.mean, expected, 0.01 * expected + 4.5 * mean.error);
}

INSTANTIATE_TEST_SUITE_P(Caches, RestirWithCache,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg,
                                           CacheChoice::apsf_apg));

}  // namespace
}  // namespace relume
