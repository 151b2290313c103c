#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"
#include "techniques/spatial/hash_grid/testing/grid_camera.h"

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

/// A cell filled with frames of 64 samples.
class OneCell {
 public:
  OneCell() : grid_(HashGridSettings{}, 64), backend_(1) {
    point_.position = Vec3(0.1f, 0.2f, 2);
    point_.normal = 1;
  }

  /// One sample in eight is `bright`, the others are `dim`.
  void fill(int frames, float dim, float bright) {
    for (int frame = 0; frame < frames; ++frame) {
      const HashGridView view = grid_.view(grid_camera());
      for (int i = 0; i < 64; ++i) view.insert(point_, Rgb(i % 8 == 0 ? bright : dim), 1.0f, 0.9f);
      grid_.end_frame(backend_);
    }
  }

  float survival(SurvivalMeasure measure) {
    AdaptivePsfSettings settings;
    settings.survival_measure = measure;
    FilteredPixel pixel;
    pixel.point = point_;
    make_adaptive_psf(settings).decide(grid_.view(grid_camera()), pixel, 0.0f);
    return pixel.survival;
  }

 private:
  HashGrid grid_;
  Backend backend_;
  CellPoint point_;
};

TEST(SurvivalMeasure, TheStandardErrorFallsWithTheNumberOfSamples) {
  OneCell cell;  // samples of mean 1 and variance 7
  cell.fill(2, 0, 8);
  EXPECT_EQ(cell.survival(SurvivalMeasure::variance), 1.0f);
  EXPECT_EQ(cell.survival(SurvivalMeasure::standard_error), 1.0f);  // 7 / 128 = 0.055
  cell.fill(14, 0, 8);
  EXPECT_EQ(cell.survival(SurvivalMeasure::variance), 1.0f);
  // 7 / 1024 = 0.0068: eq. 4.2 gives smoothstep(0.56).
  EXPECT_NEAR(cell.survival(SurvivalMeasure::standard_error), 0.59f, 0.01f);
}

TEST(SurvivalMeasure, TheStandardErrorOfABlackCellIsUnknown) {
  OneCell cell;
  cell.fill(8, 0, 0);
  EXPECT_LT(cell.survival(SurvivalMeasure::variance), 0.25f);
  EXPECT_EQ(cell.survival(SurvivalMeasure::standard_error), 1.0f);
}

TEST(SurvivalMeasure, AChangeRaisesSurvivalToOne) {
  OneCell cell;
  cell.fill(16, 1, 1.8f);
  EXPECT_LT(cell.survival(SurvivalMeasure::standard_error), 0.3f);
  cell.fill(1, 2, 3.6f);  // the first of two windows that must depart before the history is discarded
  EXPECT_LT(cell.survival(SurvivalMeasure::variance), 0.3f);
  EXPECT_EQ(cell.survival(SurvivalMeasure::standard_error), 1.0f);
}

TEST(SurvivalMeasure, TheStandardErrorKeepsTheMeanOfPathTracing) {
  CachedFrameSettings settings = small(48);
  settings.apsf.survival_measure = SurvivalMeasure::standard_error;
  CachedFrames adaptive(build("cornell"), settings);
  settings.kind = CacheKind::none;
  CachedFrames plain(build("cornell"), settings);
  double sums[2] = {};
  constexpr int kFrames = 64;
  for (int i = 0; i < kFrames; ++i) {
    for (const Rgb& p : adaptive.render()) sums[0] += static_cast<double>(luminance(p));
    for (const Rgb& p : plain.render()) sums[1] += static_cast<double>(luminance(p));
  }
  EXPECT_NEAR(sums[0] / sums[1], 1.0, 0.02);
  EXPECT_LT(static_cast<double>(adaptive.rays()), 0.7 * static_cast<double>(plain.rays()));
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
