// Tests of reciprocal pairs and of the duplication map.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "techniques/reuse/restir_pt/path_duplicates.h"
#include "techniques/reuse/restir_pt/path_spatial.h"
#include "techniques/reuse/restir_pt/testing/traced_paths.h"

namespace relume {
namespace {

using testing::rule_of;
using testing::TracedPaths;

PairSearch pairs_in(uint32_t width, uint32_t height, uint32_t edge, uint32_t frame) {
  return {.search = {.normal = {}, .depth = {}, .count = 3, .radius = 0, .width = width, .height = height},
          .seed = 5,
          .frame = frame,
          .edge = edge};
}

TEST(PathPairs, AreReciprocalWithinATile) {
  constexpr uint32_t kWidth = 37;
  constexpr uint32_t kHeight = 29;
  for (const uint32_t edge : {2u, 8u, 32u}) {
    int inside = 0;
    for (uint32_t n = 0; n < 3 * kWidth * kHeight; ++n) {
      const PairSearch pairs = pairs_in(kWidth, kHeight, edge, n % 5);
      const uint32_t pixel = n / 3;
      const uint32_t i = n % 3;
      const uint32_t other = pairs.partner(pixel % kWidth, pixel / kWidth, i);
      if (other == kNoSurface) continue;
      ++inside;
      ASSERT_LT(other, kWidth * kHeight);
      EXPECT_NE(other, pixel);
      EXPECT_EQ(pairs.partner(other % kWidth, other / kWidth, i), pixel);
      const auto apart = [](uint32_t a, uint32_t b) { return std::max(a, b) - std::min(a, b); };
      EXPECT_LT(apart(other % kWidth, pixel % kWidth), edge);
      EXPECT_LT(apart(other / kWidth, pixel / kWidth), edge);
    }
    EXPECT_GT(inside, static_cast<int>(kWidth * kHeight));
  }
}

/// Over many frames, every other pixel of a neighbourhood becomes a partner.
TEST(PathPairs, ChangeFromFrameToFrame) {
  std::set<uint32_t> partners;
  for (uint32_t frame = 0; frame < 4000; ++frame)
    partners.insert(pairs_in(64, 64, 4, frame).partner(32, 32, frame % 3));
  EXPECT_EQ(partners.size(), 7u * 7u - 1u);
}

TEST(PathPairs, LieInTilesOfTwiceTheRadius) {
  EXPECT_EQ(pair_tile_edge(1), 2u);
  EXPECT_EQ(pair_tile_edge(16), 32u);
  EXPECT_EQ(pair_tile_edge(20), 32u);
  EXPECT_EQ(pair_tile_edge(1000), 1024u);
}

/// Reservoirs of the first paths of a small image, combined in pairs.
struct Combined {
  std::vector<PathReservoir> reservoirs = std::vector<PathReservoir>(TracedPaths::kPixels);
  std::vector<Rgb> radiance = std::vector<Rgb>(TracedPaths::kPixels);
  uint64_t rays = 0;
};

template <typename Kernel>
void run(const Kernel& kernel) {
  for (uint32_t y = 0; y < TracedPaths::kEdge; ++y) {
    for (uint32_t x = 0; x < TracedPaths::kEdge; ++x) kernel(x, y);
  }
}

/// `shared`: whether both pixels of a pair share their shifts. `allocation`: paths of each pixel, as in SampledPixels.
Combined combined(const TracedPaths& traced, PathCorrection correction, bool shared,
                  const std::vector<uint32_t>& allocation = {}) {
  Combined result;
  const std::vector<Vec3> normal(TracedPaths::kPixels, Vec3(0, 0, 1));
  const std::vector<float> depth(TracedPaths::kPixels, 1.0f);
  std::vector<uint32_t> rays(TracedPaths::kPixels);
  std::vector<PairedPath> shifted[3];
  PathSpatialKernel kernel;
  kernel.shifter = traced.shifter;
  kernel.pairs = pairs_in(TracedPaths::kEdge, TracedPaths::kEdge, 8, 1);
  kernel.pairs.search.normal = view_of(normal);
  kernel.pairs.search.depth = view_of(depth);
  kernel.reservoirs = view_of(traced.reservoirs);
  kernel.records = view_of(traced.records);
  kernel.history = mutable_view_of(result.reservoirs);
  kernel.image = {mutable_view_of(result.radiance), {}, mutable_view_of(rays), {view_of(allocation)}};
  kernel.correction = correction;
  kernel.reciprocal = true;
  if (shared) {
    PathPairKernel pairs;
    pairs.shifter = traced.shifter;
    pairs.pairs = kernel.pairs;
    pairs.reservoirs = kernel.reservoirs;
    pairs.records = kernel.records;
    pairs.rays = mutable_view_of(rays);
    pairs.sampled = kernel.image.sampled;
    for (int i = 0; i < 3; ++i) {
      shifted[i].resize(TracedPaths::kPixels);
      pairs.paths[i] = mutable_view_of(shifted[i]);
      kernel.paired[i] = view_of(shifted[i]);
    }
    run(pairs);
  }
  run(kernel);
  result.rays = std::accumulate(rays.begin(), rays.end(), uint64_t{0});
  return result;
}

void expect_equal_bits(const Combined& a, const Combined& b) {
  int from_others = 0;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    EXPECT_EQ(a.radiance[p], b.radiance[p]);
    EXPECT_EQ(a.reservoirs[p].weight, b.reservoirs[p].weight);
    EXPECT_EQ(a.reservoirs[p].confidence, b.reservoirs[p].confidence);
    EXPECT_EQ(a.reservoirs[p].sample.value, b.reservoirs[p].sample.value);
    EXPECT_EQ(a.reservoirs[p].sample.first, b.reservoirs[p].sample.first);
    EXPECT_EQ(a.reservoirs[p].sample.pixel, b.reservoirs[p].sample.pixel);
    from_others += a.reservoirs[p].weight > 0.0f && a.reservoirs[p].sample.pixel != p ? 1 : 0;
  }
  EXPECT_GT(from_others, 40);
}

/// A shift from one pixel of a pair to the other serves both: half the rays, and the same bits.
TEST(PathPairs, HalveTheShifts) {
  const TracedPaths traced(find_builtin_scene("cornell-mirror")->build(), rule_of(PathShiftKind::hybrid), 6);
  const Combined twice = combined(traced, PathCorrection::exact, false);
  const Combined once = combined(traced, PathCorrection::exact, true);
  expect_equal_bits(once, twice);
  EXPECT_GT(once.rays, TracedPaths::kPixels / 2);
  EXPECT_EQ(2 * once.rays, twice.rays);
}

TEST(PathPairs, ServeEveryPixelWithAPath) {
  const TracedPaths traced(find_builtin_scene("cornell-mirror")->build(), rule_of(PathShiftKind::hybrid), 6);
  std::vector<uint32_t> allocation(TracedPaths::kPixels);
  for (uint32_t p = 0; p < TracedPaths::kPixels; p += 3) allocation[p] = 1;
  const Combined once = combined(traced, PathCorrection::exact, true, allocation);
  const Combined twice = combined(traced, PathCorrection::exact, false, allocation);
  int from_pixels_without = 0;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    EXPECT_EQ(once.radiance[p], twice.radiance[p]) << p;
    EXPECT_EQ(once.reservoirs[p].weight, twice.reservoirs[p].weight) << p;
    EXPECT_EQ(once.reservoirs[p].confidence, twice.reservoirs[p].confidence) << p;
    if (allocation[p] == 0) {
      EXPECT_EQ(once.radiance[p], Rgb(0)) << p;
      EXPECT_EQ(once.reservoirs[p].weight, traced.reservoirs[p].weight) << p;
      EXPECT_EQ(once.reservoirs[p].confidence, traced.reservoirs[p].confidence) << p;
    } else if (once.reservoirs[p].weight > 0.0f) {
      from_pixels_without += allocation[once.reservoirs[p].sample.pixel] == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(from_pixels_without, 5);
  EXPECT_LT(once.rays, twice.rays);
  EXPECT_LT(once.rays, combined(traced, PathCorrection::exact, true).rays) << "some pairs have no path";
}

/// Their inverse shifts are of the chosen path, which the pair does not know.
TEST(PathPairs, HaveTheSameBitsInOtherModes) {
  const TracedPaths traced(find_builtin_scene("cornell")->build(), rule_of(PathShiftKind::hybrid), 6);
  for (const PathCorrection correction : {PathCorrection::basic, PathCorrection::constant})
    expect_equal_bits(combined(traced, correction, true), combined(traced, correction, false));
}

/// Numbers of duplicates in an image of 40 × 30 pixels.
std::vector<uint32_t> duplicates_of(const std::vector<PathReservoir>& history) {
  std::vector<uint32_t> counts(history.size());
  PathDuplicatesKernel kernel;
  kernel.history = view_of(history);
  kernel.duplicates = mutable_view_of(counts);
  kernel.width = 40;
  kernel.height = 30;
  for (uint32_t y = 0; y < kernel.height; ++y) {
    for (uint32_t x = 0; x < kernel.width; ++x) kernel(x, y);
  }
  return counts;
}

TEST(PathDuplicates, AreCountedInAWindow) {
  const auto at = [](uint32_t x, uint32_t y) { return y * 40 + x; };
  std::vector<PathReservoir> history(40 * 30);
  for (uint32_t p = 0; p < history.size(); ++p) {
    history[p].weight = 1;
    history[p].sample.pixel = p;
  }
  EXPECT_EQ(duplicates_of(history), std::vector<uint32_t>(history.size()));
  for (const uint32_t p : {at(28, 15), at(29, 15), at(12, 7)}) history[p].sample = history[at(20, 15)].sample;
  std::vector<uint32_t> counts = duplicates_of(history);
  EXPECT_EQ(counts[at(20, 15)], 2u) << "one is out of the window";
  EXPECT_EQ(counts[at(28, 15)], 2u);
  EXPECT_EQ(counts[at(29, 15)], 1u);
  EXPECT_EQ(counts[at(21, 15)], 0u);
  history[at(28, 15)].weight = 0;  // holds no path
  counts = duplicates_of(history);
  EXPECT_EQ(counts[at(20, 15)], 1u);
  EXPECT_EQ(counts[at(28, 15)], 0u);
  history[at(12, 7)].sample.sequence = 1;  // other random numbers of the same pixel
  EXPECT_EQ(duplicates_of(history)[at(20, 15)], 0u);
}

TEST(PathDuplicates, FillTheWindowAtMost) {
  std::vector<PathReservoir> history(40 * 30);
  for (PathReservoir& reservoir : history) reservoir.weight = 1;
  const std::vector<uint32_t> counts = duplicates_of(history);
  EXPECT_EQ(counts[15 * 40 + 20], kMostDuplicates);
  EXPECT_EQ(counts[0], 9u * 9u - 1u) << "a corner of the image";
}

/// Values of RTXDI's formula: t = (n / 288)^(0.1 · 2^(6 (1 − s) − 3)), cap + t (1 − cap).
TEST(DuplicateLimit, FollowsThePublishedFormula) {
  const DuplicateLimit strong = DuplicateLimit::of(0.8f);
  EXPECT_EQ(strong.at(20, 0), 20);
  EXPECT_NEAR(strong.at(20, 1), 3.852f, 0.01f);
  EXPECT_NEAR(strong.at(20, kMostDuplicates), 1, 1e-4f);
  EXPECT_NEAR(DuplicateLimit::of(0.2f).at(20, 1), 17.356f, 0.01f);
  EXPECT_EQ(DuplicateLimit::of(0).at(20, kMostDuplicates), 20);
  for (uint32_t n = 1; n < kMostDuplicates; ++n) EXPECT_GT(strong.at(20, n), strong.at(20, n + 1));
}

}  // namespace
}  // namespace relume
