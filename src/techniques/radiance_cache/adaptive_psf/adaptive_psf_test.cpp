#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

constexpr VarianceThresholds kThresholds{1, 3};

TEST(VarianceFunctions, LinearSurvivalIsEquation41) {
  EXPECT_EQ(linear_survival(kThresholds, 0.5f), 0.0f);
  EXPECT_EQ(linear_survival(kThresholds, 2.0f), 0.5f);
  EXPECT_EQ(linear_survival(kThresholds, 9.0f), 1.0f);
}

TEST(VarianceFunctions, SmoothLinearSurvivalIsEquation42) {
  // For v0 = 1, v1 = 3: e1 = 0.75, x(v) = (v − 2)/10 + 0.375, smoothstep over [0, 0.75].
  const auto by_hand = [](double v) {
    double s = ((v - 2.0) / 10.0 + 0.375) / 0.75;
    s = s < 0 ? 0 : (s > 1 ? 1 : s);
    return s * s * (3.0 - 2.0 * s);
  };
  for (const double v : {-5.0, 0.0, 1.0, 2.0, 3.0, 4.5, 9.0})
    EXPECT_NEAR(smooth_linear_survival(kThresholds, static_cast<float>(v)), by_hand(v), 1e-6);
  // According to the errata, about one third at v0 and two thirds at v1.
  const VarianceThresholds narrow{0.1f, 0.2f};
  EXPECT_NEAR(smooth_linear_survival(narrow, 0.1f), 1.0 / 3.0, 0.03);
  EXPECT_NEAR(smooth_linear_survival(narrow, 0.2f), 2.0 / 3.0, 0.03);
}

TEST(VarianceFunctions, BlendsPreferPathsBetweenTheThresholds) {
  EXPECT_EQ(step_blend(kThresholds, 0.5f), 1.0f);
  EXPECT_EQ(step_blend(kThresholds, 2.0f), 0.0f);
  EXPECT_EQ(step_blend(kThresholds, 3.5f), 1.0f);
  // Eq. 4.5 in the middle: 1 − (1 − 2/8) = 0.25; far away: 1.
  EXPECT_NEAR(one_over_square_blend(kThresholds, 2.0f), 0.25, 1e-6);
  EXPECT_GT(one_over_square_blend(kThresholds, 1000.0f), 0.999f);
  EXPECT_NEAR(one_over_square_blend(kThresholds, 1.0f), one_over_square_blend(kThresholds, 3.0f), 1e-6);
}

TEST(VarianceFunctions, RefuseThresholdsOutsideTheirDomain) {
  AdaptivePsfSettings settings;
  settings.survival_v0 = 2;
  settings.survival_v1 = 10;
  EXPECT_THROW(make_adaptive_psf(settings), Error);
  settings.survival_v1 = 1;
  EXPECT_THROW(make_adaptive_psf(settings), Error);
  settings.survival_v1 = 9.9f;
  EXPECT_NO_THROW(make_adaptive_psf(settings));
}

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

CachedFrameSettings small(int size) {
  CachedFrameSettings s;
  s.kind = CacheKind::apsf;
  s.width = s.height = size;
  s.apsf.min_samples = 16;
  return s;
}

TEST(AdaptivePsf, UnknownCellsFollowEveryPath) {
  CachedFrames frames(build("cornell"), small(48));
  frames.render();
  for (const FilteredPixel& p : frames.pixels()) {
    EXPECT_FALSE(p.culled);
    EXPECT_EQ(p.survival, 1.0f);
  }
}

TEST(AdaptivePsf, CulledPixelsShowTheirCellWithAnyBlend) {
  CachedFrameSettings settings = small(48);
  settings.apsf.blend = BlendFunction::zero;  // the path alone
  settings.apsf.survival_v0 = 1;
  settings.apsf.survival_v1 = 8;
  CachedFrames frames(build("cornell"), settings);
  for (int i = 0; i < 4; ++i) frames.render();
  const HashGridView grid = frames.grid().view(frames.scene().view().camera);
  frames.trace();
  frames.resolve();
  size_t culled = 0;
  for (size_t i = 0; i < frames.pixels().size(); ++i) {
    const FilteredPixel& p = frames.pixels()[i];
    if (!p.filtered) continue;
    if (!p.culled) {  // with and without a known cell
      EXPECT_EQ(frames.radiance()[i], p.unfiltered + p.traced);
    }
    if (!p.culled) continue;
    ++culled;
    EXPECT_EQ(p.traced, Rgb(0));
    const Rgb cell = grid.moments(p.point, grid.find(grid.keys.address(p.point))).mean;
    EXPECT_EQ(frames.radiance()[i], p.unfiltered + p.factor * cell);
  }
  EXPECT_GT(culled, 200u);
}

TEST(AdaptivePsf, TheSurvivalFloorFeedsEveryCell) {
  CachedFrameSettings settings = small(16);
  settings.apsf.survival = SurvivalFunction::linear;
  settings.apsf.survival_floor = 0.25f;
  // Without noise all variances are 0, so each path survives with the floor's probability.
  CachedFrames frames(testing::plate_under_sky(testing::matte(Rgb(0.5f))), settings);
  for (int i = 0; i < 8; ++i) frames.render();
  double alive = 0;
  constexpr int kFrames = 64;
  for (int i = 0; i < kFrames; ++i) {
    frames.render();
    for (const FilteredPixel& p : frames.pixels()) alive += p.culled ? 0 : 1;
  }
  alive /= 16 * 16 * kFrames;
  EXPECT_NEAR(alive, 0.25, 0.02);  // five standard errors of 16,384 decisions are 0.017
}

TEST(AdaptivePsf, TracesFewerRays) {
  CachedFrameSettings settings = small(48);
  CachedFrames adaptive(build("cornell"), settings);
  settings.kind = CacheKind::psf;
  CachedFrames full(build("cornell"), settings);
  for (int i = 0; i < 8; ++i) {
    adaptive.render();
    full.render();
  }
  EXPECT_LT(static_cast<double>(adaptive.rays()), 0.85 * static_cast<double>(full.rays()));
}

TEST(AdaptivePsf, PathsNeededByDeltaLobesSurvive) {
  Material coated = testing::matte(Rgb(0.5f));
  coated.clearcoat = 1;
  coated.clearcoat_roughness = 0;
  CachedFrames frames(testing::plate_under_sky(coated), small(16));
  for (int i = 0; i < 6; ++i) frames.render();
  for (const FilteredPixel& p : frames.pixels()) EXPECT_FALSE(p.culled);
}

}  // namespace
}  // namespace relume
