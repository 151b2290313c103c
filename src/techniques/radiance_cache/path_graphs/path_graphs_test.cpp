#include "techniques/radiance_cache/path_graphs/path_graphs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

CachedFrameSettings small(CacheKind kind, int size) {
  CachedFrameSettings s;
  s.kind = kind;
  s.width = s.height = size;
  return s;
}

double mean_of(const std::vector<Rgb>& pixels) {
  double sum = 0;
  for (const Rgb& p : pixels) sum += static_cast<double>(luminance(p));
  return sum / static_cast<double>(pixels.size());
}

/// Mean luminance over `count` frames after `skip` others.
double mean_over(CachedFrames& frames, int skip, int count) {
  for (int i = 0; i < skip; ++i) frames.render();
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += mean_of(frames.render()) / count;
  return sum;
}

/// Mean over all pixels of the variance between frames.
double variance_of_frames(CachedFrames& frames) {
  constexpr int kFrames = 16;
  for (int i = 0; i < 8; ++i) frames.render();
  std::vector<double> sums(frames.radiance().size(), 0.0);
  std::vector<double> squares = sums;
  for (int i = 0; i < kFrames; ++i) {
    const std::vector<Rgb>& image = frames.render();
    for (size_t k = 0; k < image.size(); ++k) {
      const double y = std::min(2.0, static_cast<double>(luminance(image[k])));  // ignores noise at edges of the lamp
      sums[k] += y / kFrames;
      squares[k] += y * y / kFrames;
    }
  }
  double variance = 0;
  for (size_t k = 0; k < sums.size(); ++k)
    variance += (squares[k] - sums[k] * sums[k]) / static_cast<double>(sums.size());
  return variance;
}

constexpr float kVarianceConstants[] = {0.0f, 0.001f, 0.05f, 1.0f, 100.0f, 1e12f};

class Furnace : public ::testing::TestWithParam<CacheKind> {};

TEST_P(Furnace, ClosedWithAlbedoOneHalf) {
  constexpr int kBounces = 5;
  const bool graph = GetParam() == CacheKind::apg || GetParam() == CacheKind::apsf_apg;
  for (const float constant : kVarianceConstants) {
    for (const VarianceMeasure measure : {VarianceMeasure::relative, VarianceMeasure::absolute}) {
      CachedFrameSettings settings = small(GetParam(), 24);
      settings.max_bounces = kBounces;
      settings.apg.variance_constant = constant;
      settings.apg.variance = measure;
      settings.apsf.min_samples = 16;
      CachedFrames frames(testing::closed_furnace(0.5f), settings);
      // Five standard errors of 23,000 paths, whose standard deviation is a quarter of the mean, are 0.8 %. The first
      // frames, whose cells have few samples, are included: with both techniques they are 0.5 to 1 % too bright.
      const double tolerance = GetParam() == CacheKind::apsf_apg ? 0.018 : 0.01;
      EXPECT_NEAR(mean_over(frames, 0, 40) / testing::closed_furnace_radiance(0.5, kBounces), 1.0, tolerance)
          << "constant " << constant;
      if (!graph) break;
    }
    if (!graph) break;
  }
}

TEST_P(Furnace, PlateIsExact) {
  for (const float constant : kVarianceConstants) {
    CachedFrameSettings settings = small(GetParam(), 16);
    settings.apg.variance_constant = constant;
    settings.russian_roulette = false;
    CachedFrames frames(testing::plate_under_sky(testing::matte(Rgb(0.5f, 0.25f, 0.125f))), settings);
    for (int i = 0; i < 4; ++i) frames.render();
    for (const Rgb& p : frames.radiance()) {  // only rounding errors, no noise
      ASSERT_NEAR(p.r, 0.5f, 1e-4f);
      ASSERT_NEAR(p.g, 0.25f, 1e-4f);
      ASSERT_NEAR(p.b, 0.125f, 1e-4f);
    }
  }
}

class LongFurnace : public ::testing::TestWithParam<CacheKind> {};

TEST_P(LongFurnace, DoesNotDriftOverTenThousandFrames) {
  CachedFrameSettings settings = small(GetParam(), 6);
  settings.max_bounces = 3;
  settings.psf.grid.max_count = 128;
  settings.psf.grid.cell_size = 3;
  CachedFrames frames(testing::closed_furnace(0.5f), settings);
  const double early = mean_over(frames, 50, 1000);
  const double late = mean_over(frames, 7950, 1000);
  // 36,000 paths each, with standard errors as above.
  EXPECT_NEAR(early / testing::closed_furnace_radiance(0.5, 3), 1.0, 0.01);
  EXPECT_NEAR(late / early, 1.0, 0.01);
}

class Caches : public ::testing::TestWithParam<CacheKind> {};

TEST_P(Caches, SameBitsWithAnyNumberOfThreads) {
  const auto run = [](int threads) {
    CachedFrameSettings settings = small(GetParam(), 45);
    settings.threads = threads;
    settings.apsf.min_samples = 16;
    CachedFrames frames(build("cornell"), settings);
    std::vector<Rgb> all;
    for (int i = 0; i < 4; ++i) {
      const std::vector<Rgb>& frame = frames.render();
      all.insert(all.end(), frame.begin(), frame.end());
    }
    EXPECT_EQ(frames.grid().statistics().dropped, 0u);
    return all;
  };
  const std::vector<Rgb> one = run(1);
  for (const int threads : {2, 5}) {
    const std::vector<Rgb> many = run(threads);
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(Rgb)), 0) << threads;
  }
}

TEST_P(Caches, AreBitExactWithWatchingPolicies) {
  const auto run = [](bool watched) {
    CachedFrameSettings settings = small(GetParam(), 45);
    settings.apsf.min_samples = 16;
    settings.watched = watched;
    CachedFrames frames(build("cornell-spheres"), settings);
    std::vector<Rgb> all;
    for (int i = 0; i < 4; ++i) {
      const std::vector<Rgb>& frame = frames.render();
      all.insert(all.end(), frame.begin(), frame.end());
    }
    return all;
  };
  EXPECT_EQ(run(true), run(false));
}

TEST_P(Caches, ATableSixteenTimesTooSmallDegrades) {
  CachedFrameSettings settings = small(GetParam(), 48);
  CachedFrames roomy(build("cornell"), settings);
  const double expected = mean_over(roomy, 2, 12);
  settings.psf.grid.max_cells = static_cast<int>(roomy.grid().statistics().cells / 16);
  CachedFrames tight(build("cornell"), settings);
  const double mean = mean_over(tight, 2, 12);
  EXPECT_EQ(roomy.grid().statistics().dropped, 0u);
  EXPECT_EQ(tight.grid().statistics().dropped, 0u);
  EXPECT_GT(tight.grid().statistics().discarded, 0u);
  // Most cells have the samples of one frame only: more noise, the same mean.
  EXPECT_NEAR(mean / expected, 1.0, 0.06);
  const double noise = variance_of_frames(roomy);
  const double more_noise = variance_of_frames(tight);
  EXPECT_GT(more_noise, noise);
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return testing::name_of(info.param); }
/// Diffuse walls below smooth interfaces. The light of delta lobes at later vertices must not be lost.
TEST_P(Caches, PolishedWallsLoseNoLight) {
  Scene scene = build("cornell");
  for (Material& m : scene.materials) {
    m.roughness = 0;
    m.ior = 2.5f;
  }
  const auto mean_with = [&](CachedFrameSettings settings, uint32_t max_bounces) {
    settings.max_bounces = max_bounces;
    CachedFrames frames(scene, settings);
    return mean_over(frames, 32, 256);
  };
  // Rendered once for all caches.
  static const double lamp = mean_with(small(CacheKind::none, 32), 0);
  static const double expected = mean_with(small(CacheKind::none, 32), 6) - lamp;
  CachedFrameSettings settings = small(GetParam(), 32);
  const bool graph = GetParam() == CacheKind::apg || GetParam() == CacheKind::apsf_apg;
  const bool blends = GetParam() == CacheKind::apsf || GetParam() == CacheKind::apsf_apg;
  for (const float constant : {0.1f, 0.0f}) {
    for (const BlendFunction blend : {BlendFunction::zero, BlendFunction::one}) {
      settings.apg.variance_constant = constant;
      settings.apsf.blend = blend;
      // Standard errors of 0.6 % each and the bias of path graphs, up to 3 %.
      EXPECT_NEAR((mean_with(settings, 6) - lamp) / expected, 1, 0.045)
          << "constant " << constant << ", blend " << static_cast<int>(blend);
      if (!blends) break;  // the other function would change nothing
    }
    if (!graph) break;
  }
}

INSTANTIATE_TEST_SUITE_P(AllCaches, Furnace, ::testing::ValuesIn(testing::kCacheKinds), case_name);
// Cells alone, and with both techniques that build on them.
INSTANTIATE_TEST_SUITE_P(SomeCaches, LongFurnace, ::testing::Values(CacheKind::psf, CacheKind::apsf_apg), case_name);
INSTANTIATE_TEST_SUITE_P(SlowCaches, LongFurnace, ::testing::Values(CacheKind::apsf, CacheKind::apg), case_name);
INSTANTIATE_TEST_SUITE_P(AllCaches, Caches, ::testing::ValuesIn(testing::kCacheKinds), case_name);

TEST(PathGraph, InfiniteConstantIsPathTracing) {
  CachedFrameSettings settings = small(CacheKind::apg, 32);
  settings.apg.variance_constant = 1e12f;
  settings.apg.variance = VarianceMeasure::absolute;
  settings.russian_roulette = false;
  CachedFrames graph(build("cornell"), settings);
  settings.kind = CacheKind::none;
  CachedFrames path(build("cornell"), settings);
  for (int i = 0; i < 2; ++i) {
    const std::vector<Rgb>& a = graph.render();
    const std::vector<Rgb>& b = path.render();
    for (size_t p = 0; p < a.size(); ++p) {  // the same sums in another order
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[p][c], b[p][c], 1e-4f * (1.0f + b[p][c])) << p;
    }
  }
}

TEST(PathGraph, AConstantOfZeroShowsTheCells) {
  CachedFrameSettings settings = small(CacheKind::apg, 32);
  settings.apg.variance_constant = 0;
  CachedFrames frames(build("cornell"), settings);
  for (int i = 0; i < 6; ++i) frames.render();
  size_t at_first = 0;
  size_t filtered = 0;
  for (const FilteredPixel& p : frames.pixels()) {
    filtered += p.filtered ? 1 : 0;
    at_first += p.filtered && p.termination == 1 ? 1 : 0;
  }
  EXPECT_GT(at_first, filtered * 9 / 10);
}

TEST(PathGraph, LargerConstantsTerminateLater) {
  double before = 0;
  for (const float constant : {0.01f, 3.0f, 30.0f, 300.0f}) {
    CachedFrameSettings settings = small(CacheKind::apg, 32);
    settings.apg.variance_constant = constant;
    settings.apg.feed = 1;
    CachedFrames frames(build("corridor"), settings);
    double depth = 0;
    for (int i = 0; i < 48; ++i) {
      frames.render();
      for (const FilteredPixel& p : frames.pixels()) depth += i < 40 ? 0 : p.termination;
    }
    EXPECT_GT(depth, 1.02 * before) << constant;
    before = depth;
  }
}

TEST(PathGraphWithSurvival, ShowsTheGraphWhereNoPathIsCulled) {
  for (const float constant : {0.0f, 0.1f, 1e12f}) {
    CachedFrameSettings settings = small(CacheKind::apsf_apg, 32);
    settings.apsf.survival = SurvivalFunction::one;
    settings.apg.variance_constant = constant;
    CachedFrames both(build("cornell"), settings);
    settings.kind = CacheKind::apg;
    CachedFrames graph(build("cornell"), settings);
    for (int i = 0; i < 12; ++i) {  // cells with fewer and with more samples than apsf.min-samples
      const std::vector<Rgb>& a = both.render();
      const std::vector<Rgb>& b = graph.render();
      ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)), 0) << constant << " " << i;
    }
  }
}

TEST(PathGraphWithSurvival, SurvivorsShowTheGraphAndCulledPixelsTheirCell) {
  CachedFrameSettings settings = small(CacheKind::apsf_apg, 48);
  settings.apsf.min_samples = 16;
  settings.apg.variance_constant = 1e12f;
  settings.apg.variance = VarianceMeasure::absolute;
  settings.russian_roulette = false;
  CachedFrames both(build("cornell"), settings);
  settings.kind = CacheKind::none;
  CachedFrames path(build("cornell"), settings);
  size_t culled = 0;
  for (int i = 0; i < 6; ++i) {
    both.render();
    path.render();
    for (size_t k = 0; k < both.pixels().size(); ++k) {
      const FilteredPixel& p = both.pixels()[k];
      const Rgb shown = both.radiance()[k];
      culled += p.culled ? 1 : 0;
      for (int c = 0; c < 3 && !p.culled; ++c)  // with an infinite constant, the graph equals the path tracer
        ASSERT_NEAR(shown[c], path.radiance()[k][c], 1e-4f * (1.0f + shown[c])) << k;
      EXPECT_EQ(p.blend, p.culled ? 1.0f : 0.0f);
    }
  }
  EXPECT_GT(culled, 500u);
}

TEST(PathGraphWithSurvival, TheConstantChangesTheImageAsItDoesWithout) {
  for (const CacheKind kind : {CacheKind::apg, CacheKind::apsf_apg}) {
    const auto variance = [&](float constant) {
      CachedFrameSettings settings = small(kind, 32);
      settings.apg.variance_constant = constant;
      CachedFrames frames(build("corridor"), settings);
      return variance_of_frames(frames);
    };
    // 0.0196 and 0.0018 for both caches. If cells were shown instead of graphs, both would be 0.0018.
    EXPECT_GT(variance(1e12f), 5 * variance(0.3f)) << testing::name_of(kind);
  }
}

TEST(PathGraph, CoarserCellsBeyondTheFirstVertexAreFewer) {
  uint64_t before = ~uint64_t{0};
  for (const int coarsening : {0, 1, 2}) {
    CachedFrameSettings settings = small(CacheKind::apg, 32);
    settings.apg.deep_coarsening = coarsening;
    CachedFrames frames(build("cornell"), settings);
    for (int i = 0; i < 6; ++i) frames.render();
    EXPECT_LT(frames.grid().statistics().cells, before) << coarsening;
    before = frames.grid().statistics().cells;
  }
}

// Whether a vertex takes a sample must not depend on the rest of its path, or cells would be biased to dark samples.
TEST(PathGraph, VerticesBeyondTheWaitingLimitAreCounted) {
  CachedFrameSettings settings = small(CacheKind::apg, 16);
  settings.max_bounces = 16;
  settings.russian_roulette = false;
  settings.psf.grid.undersampled_cells = UndersampledCells::keep;  // no samples for coarser cells
  CachedFrames frames(testing::closed_furnace(0.9f), settings);
  frames.render();  // all cells are empty: of 16 vertices, eight have samples, which wait for the end of the path
  EXPECT_EQ(frames.grid().statistics().samples, 8u * 16u * 16u);
  EXPECT_EQ(frames.grid().statistics().skipped_vertices, 8u * 16u * 16u);
}

TEST(PathGraph, SamplesWeighNoMoreThanCellsHold) {
  CachedFrameSettings settings = small(CacheKind::apg, 64);
  settings.apg.feed = 1e-4f;
  settings.apg.variance_constant = 0;  // the contribution ends at the first cell
  settings.max_bounces = 3;
  CachedFrames frames(build("cornell"), settings);
  float heaviest = 0;
  for (int i = 0; i < 20; ++i) {
    frames.trace();  // the samples of the next render()
    for (const CellSums& sums : frames.grid().view(frames.scene().view().camera).sums) {
      const float weight = static_cast<float>(sums.weight) * kCellWeightUnit;
      if (sums.count == 1) heaviest = std::max(heaviest, weight);
    }
    frames.render();
  }
  EXPECT_GT(heaviest, 0.5f * kCellWeightMax);  // some paths feed, although apg.feed is below 1 / kCellWeightMax
  EXPECT_LE(heaviest, 1.001f * kCellWeightMax);
}

TEST(PathGraph, LessFeedTracesFewerRays) {
  uint64_t before = 0;
  for (const float feed : {0.0f, 0.3f, 1.0f}) {
    CachedFrameSettings settings = small(CacheKind::apg, 32);
    settings.apg.feed = feed;
    CachedFrames frames(build("cornell"), settings);
    for (int i = 0; i < 6; ++i) frames.render();
    EXPECT_GT(frames.rays(), before) << feed;
    before = frames.rays();
  }
}

}  // namespace
}  // namespace relume
