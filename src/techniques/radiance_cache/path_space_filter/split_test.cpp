// Tests cells of their own for diffuse and for specular light.
#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

/// The box with glossy interfaces over its coloured walls.
Scene glossy_box() {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    m.specular = 1;
    m.roughness = 0.4f;
    m.ior = 2;
  }
  return scene;
}

CachedFrameSettings small(CacheKind kind, bool split) {
  CachedFrameSettings s;
  s.kind = kind;
  s.width = s.height = 32;
  s.psf.split = split;
  return s;
}

double mean_of(const std::vector<Rgb>& pixels) {
  double sum = 0;
  for (const Rgb& p : pixels) sum += static_cast<double>(luminance(p));
  return sum / static_cast<double>(pixels.size());
}

TEST(SplitCells, PartsAddUpToTheSampleOfThePath) {
  CachedFrameSettings settings = small(CacheKind::psf, true);
  settings.russian_roulette = false;
  CachedFrames filtered(glossy_box(), settings);
  settings.kind = CacheKind::none;
  CachedFrames plain(glossy_box(), settings);
  filtered.render();
  plain.render();
  size_t split = 0;
  for (size_t i = 0; i < filtered.pixels().size(); ++i) {
    const FilteredPixel& p = filtered.pixels()[i];
    split += p.split ? 1 : 0;
    const Rgb traced = p.unfiltered + p.traced;
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(traced[c], plain.radiance()[i][c], 5e-4f * (1.0f + plain.radiance()[i][c])) << i;
  }
  EXPECT_GT(split, 500u);
}

TEST(SplitCells, PixelsShowBothCells) {
  CachedFrameSettings settings = small(CacheKind::psf, true);
  settings.psf.grid.direction_bins = 8;
  settings.psf.grid.roughness_bins = 8;
  CachedFrames frames(glossy_box(), settings);
  for (int i = 0; i < 3; ++i) frames.render();
  frames.trace();
  frames.resolve();
  const HashGridView grid = frames.grid().view(frames.scene().view().camera);
  size_t split = 0;
  for (size_t i = 0; i < frames.pixels().size(); ++i) {
    const FilteredPixel& p = frames.pixels()[i];
    if (!p.split) continue;
    ++split;
    EXPECT_EQ(p.point.direction, 0u);
    const OtherCells& other = frames.others()[i];
    EXPECT_NE(other.specular_direction, 0u);
    const Rgb diffuse = p.factor * grid.moments(p.point).mean;
    const Rgb specular = other.specular_factor * grid.moments(other.specular_point(p.point)).mean;
    const Rgb shown = p.unfiltered + diffuse + specular;
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(frames.radiance()[i][c], shown[c], 1e-5f * (1.0f + shown[c])) << i;
  }
  EXPECT_GT(split, 500u);
}

TEST(SplitCells, DiffuseCellsIgnoreTheDirection) {
  const auto cells = [](bool split, int direction_bins) {
    CachedFrameSettings settings = small(CacheKind::psf, split);
    settings.psf.grid.direction_bins = direction_bins;
    settings.psf.grid.undersampled_cells = UndersampledCells::keep;
    CachedFrames frames(glossy_box(), settings);
    frames.render();
    return frames.grid().statistics().cells;
  };
  const uint64_t joint = cells(false, 0);
  const uint64_t directional = cells(false, 16);
  EXPECT_GT(directional, joint);
  EXPECT_GT(cells(true, 16), cells(true, 0));
  EXPECT_LE(cells(true, 16), joint + directional);  // diffuse cells without, and specular cells with directions
}

class SplitCellsOf : public ::testing::TestWithParam<CacheKind> {};

TEST_P(SplitCellsOf, KeepTheMeanOfPathTracing) {
  constexpr int kFrames = 64;
  const auto mean = [&](CacheKind kind, bool split) {
    CachedFrameSettings settings = small(kind, split);
    settings.apsf.min_samples = 16;
    CachedFrames frames(glossy_box(), settings);
    double sum = 0;
    for (int i = 0; i < kFrames; ++i) sum += mean_of(frames.render()) / kFrames;
    return sum;
  };
  // The bound of the combination tests, and the noise of independent roulette.
  EXPECT_NEAR(mean(GetParam(), true) / mean(CacheKind::none, false), 1.0, 0.03);
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return testing::name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(Caches, SplitCellsOf, ::testing::Values(CacheKind::psf, CacheKind::apsf), case_name);

}  // namespace
}  // namespace relume
