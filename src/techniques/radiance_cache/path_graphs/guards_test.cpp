// Tests the guards of path graphs: cells larger than the last segment or than the ray cone are not read.
#include <gtest/gtest.h>

#include <cstring>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/path_graphs.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

CachedFrameSettings small(CacheKind kind, int size, bool guards) {
  CachedFrameSettings s;
  s.kind = kind;
  s.width = s.height = size;
  s.apg.guards = guards;
  return s;
}

TEST(Guards, ProtectCellsLargerThanSegmentOrCone) {
  EXPECT_FALSE(guarded(1, 2, 3));
  EXPECT_TRUE(guarded(1, 0.9f, 3));
  EXPECT_TRUE(guarded(1, 2, 0.9f));
  EXPECT_TRUE(guarded(1, 2, 0));  // a mirror or a camera of no resolution
}

class GuardedGraphs : public ::testing::TestWithParam<CacheKind> {};

TEST_P(GuardedGraphs, KeepTheEnergy) {
  constexpr int kBounces = 5;
  constexpr int kFrames = 40;
  for (const float cell_size : {4.0f, 8.0f}) {  // cells smaller than most segments, and larger ones
    for (const float constant : {0.0f, 0.001f, 0.05f, 1.0f}) {
      CachedFrameSettings settings = small(GetParam(), 24, true);
      settings.max_bounces = kBounces;
      settings.psf.grid.cell_size = cell_size;
      settings.apg.variance_constant = constant;
      settings.apsf.min_samples = 16;
      CachedFrames frames(testing::closed_furnace(0.5f), settings);
      double mean = 0;
      for (int i = 0; i < kFrames; ++i) {
        for (const Rgb& p : frames.render()) mean += static_cast<double>(luminance(p)) / (24 * 24 * kFrames);
      }
      // Five standard errors of 0.8 % in total, and the bias of the first frames. Lost light would be several times
      // that.
      EXPECT_NEAR(mean / testing::closed_furnace_radiance(0.5, kBounces), 1.0, 0.025)
          << "constant " << constant << ", cell size " << cell_size;
    }
  }
}

TEST_P(GuardedGraphs, PassCellsAsLargeAsTheRoom) {
  const auto rays = [](bool guards) {
    CachedFrameSettings settings = small(GetParam(), 32, guards);
    settings.psf.grid.cell_size = 64;
    settings.apsf.survival = SurvivalFunction::one;
    settings.apg.feed = 0;
    CachedFrames frames(find_builtin_scene("cornell")->build(), settings);
    for (int i = 0; i < 4; ++i) frames.render();
    return static_cast<double>(frames.rays());
  };
  // Without guards, paths end at the second vertex.
  EXPECT_GT(rays(true), 1.5 * rays(false));
}

TEST_P(GuardedGraphs, SpareTheFirstVertex) {
  const auto images = [](bool guards) {
    CachedFrameSettings settings = small(GetParam(), 16, guards);
    settings.apg.variance_constant = 0;
    CachedFrames frames(testing::plate_under_sky(testing::matte(Rgb(0.5f))), settings);
    std::vector<Rgb> all;
    for (int i = 0; i < 6; ++i) {
      const std::vector<Rgb>& image = frames.render();
      all.insert(all.end(), image.begin(), image.end());
    }
    return all;
  };
  const std::vector<Rgb> with = images(true);
  const std::vector<Rgb> without = images(false);
  EXPECT_EQ(std::memcmp(with.data(), without.data(), with.size() * sizeof(Rgb)), 0);
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return testing::name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(Graphs, GuardedGraphs, ::testing::Values(CacheKind::apg, CacheKind::apsf_apg), case_name);

}  // namespace
}  // namespace relume
