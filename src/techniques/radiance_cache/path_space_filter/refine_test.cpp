// Tests finer cells.
#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

TEST(FinerCells, PointsAreJitteredHalfAsMuch) {
  CellKeys keys;
  keys.cone_width = 0.01f;  // one level everywhere
  testing::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    SurfacePoint sp{};
    sp.position = 20.0f * Vec3(random.next(), random.next(), random.next());
    sp.ng = sp.frame.n = glm::normalize(Vec3(random.next(), random.next(), random.next()) - 0.5f);
    const CellPoint p = keys.point(sp, Vec2(random.next(), random.next()), 0, false);
    const CellPoint finer = finer_point(keys, p, finer_offset(keys, p, sp.position));
    const float edge = power_of_two(keys.level_of(p));
    const Vec3 expected = 0.5f * (sp.position + p.position);
    EXPECT_LE(glm::length(finer.position - expected), 0.001f * edge);  // 10 bits per component
    EXPECT_NE(finer.layer, p.layer);
    EXPECT_NE(keys.address(finer, -1).fingerprint, keys.address(p, 0).fingerprint);
  }
}

TEST(FinerCells, AreShownByTheirDifferenceBeyondTheNoise) {
  // A step of the light within a cell, which the finer cells resolve.
  HashGridSettings settings;
  settings.change_detection = 0;
  settings.inherited_count = 0;
  HashGrid grid(settings, 64);
  Backend backend(1);
  CameraView camera;
  camera.half_extent = Vec2(0.5f);
  camera.resolution = Vec2(1000);
  FilteredPixel pixel;
  pixel.filtered = true;
  pixel.factor = Rgb(1);
  OtherCells others;
  const auto fill = [&](float spread, float spread_of_cell = 0) {
    const HashGridView view = grid.view(camera);
    pixel.point.position = Vec3(0.1f, 0.2f, 2);
    pixel.point.normal = 1;
    others.finer = finer_offset(view.keys, pixel.point, pixel.point.position);
    const CellPoint finer = finer_point(view.keys, pixel.point, others.finer);
    for (int i = 0; i < 64; ++i) {
      const float sign = i % 2 == 0 ? 1.0f : -1.0f;
      view.insert(pixel.point, Rgb(2 + sign * spread_of_cell), 1.0f, 0.9f);
      view.insert_finer(finer, Rgb(1 + sign * spread), 1.0f);
    }
    grid.end_frame(backend);
  };
  const auto shown = [&](float refine) {
    Rgb radiance(0);
    ResolveCellsKernel kernel;
    kernel.grid = grid.view(camera);
    kernel.pixels = {&pixel, 1};
    kernel.radiance = {&radiance, 1};
    kernel.width = 1;
    kernel.refine = refine;
    kernel.others = {&others, 1};
    kernel(0, 0);
    return radiance.g;
  };
  fill(0);
  EXPECT_EQ(shown(0), 2.0f);
  EXPECT_EQ(shown(2), 1.0f);  // without noise, the finer cell
  grid.clear(backend);
  fill(1);
  // The variance 64/63 of 64 samples: with two standard errors, 4/63 of the way back to the larger cell.
  EXPECT_NEAR(shown(2), 1.0f + 4.0f / 63.0f, 1e-3f);
  EXPECT_EQ(shown(10), 2.0f);
  grid.clear(backend);
  fill(0, 2);
  EXPECT_EQ(shown(10), 2.0f);  // the finer cell may have missed the bright samples of the larger one
}

class FinerCellsOf : public ::testing::TestWithParam<CacheKind> {};

TEST_P(FinerCellsOf, KeepTheMeanOfPathTracing) {
  constexpr int kFrames = 32;
  const auto mean = [&](CacheKind kind, float refine) {
    CachedFrameSettings settings;
    settings.kind = kind;
    settings.width = settings.height = 48;
    settings.psf.refine = refine;
    settings.apsf.min_samples = 16;
    CachedFrames frames(find_builtin_scene("cornell")->build(), settings);
    double sum = 0;
    for (int i = 0; i < kFrames; ++i) {
      for (const Rgb& p : frames.render()) sum += static_cast<double>(luminance(p)) / (48 * 48 * kFrames);
    }
    return sum;
  };
  EXPECT_NEAR(mean(GetParam(), 2) / mean(CacheKind::none, 0), 1.0, 0.025);
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return testing::name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(Caches, FinerCellsOf, ::testing::Values(CacheKind::psf, CacheKind::apsf), case_name);

}  // namespace
}  // namespace relume
