// Cached ends of paths: their shifts, and the weights that follow from them.
#include "techniques/reuse/restir_pt/path_suffix.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "techniques/reuse/restir_pt/testing/traced_paths.h"

namespace relume {
namespace {

using testing::rule_of;
using testing::TracedPaths;

/// A policy of a cache without cells.
struct NoCells : NoPolicy {
  RELUME_HD bool goes_on(PathState&) { return true; }
};

struct SuffixWithoutCells {
  static constexpr bool uses_cells = true;
  using Policy = NoCells;

  RELUME_HD NoCells policy(const SampleIndex&, uint32_t, uint32_t, float) const { return {}; }
};

TracedPaths trace(const char* scene) {
  return {find_builtin_scene(scene)->build(), rule_of(PathShiftKind::hybrid), 6, 3, false, SuffixWithoutCells{}};
}

std::vector<uint32_t> cached_pixels(const TracedPaths& traced) {
  std::vector<uint32_t> pixels;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    if (traced.has_path(p) && traced.reservoirs[p].sample.end() == PathEnd::cached) pixels.push_back(p);
  }
  return pixels;
}

bool near(float a, float b) { return std::fabs(a - b) <= 0.01f * std::fabs(b); }

/// The path of a pixel, shifted to that pixel, is itself.
TEST(CachedEnd, KeepsValueAndTargetWithinAPixel) {
  for (const char* scene : {"cornell", "cornell-mirror"}) {
    const TracedPaths traced = trace(scene);
    const std::vector<uint32_t> pixels = cached_pixels(traced);
    size_t other = 0;
    for (const uint32_t p : pixels) {
      const PathReservoir& own = traced.reservoirs[p];
      ASSERT_TRUE(exists(traced.shifter.context.scene, own.sample, traced.shifter.context.max_bounces));
      const Shifted self = traced.shifted(p, p);
      other += near(self.target, own.target) && near(luminance(self.value), luminance(own.sample.value)) ? 0u : 1u;
    }
    EXPECT_GT(pixels.size(), 50u) << scene;
    // Rounding may move a ray to the other side of an edge, or a density across a bound.
    EXPECT_LE(other, 2 + pixels.size() / 100) << scene;
  }
}

/// Weights are functions of such quotients. They are exact only if light of another distribution has the same.
TEST(CachedEnd, HasTargetsWhoseQuotientIsTheSameForAnyLight) {
  const TracedPaths traced = trace("cornell");
  int pairs = 0;
  int coloured = 0;
  for (const uint32_t p : cached_pixels(traced)) {
    for (const uint32_t to : {p + 1, p + 5}) {
      if (to >= TracedPaths::kPixels || !traced.records[to].valid()) continue;
      StoredPath path = traced.reservoirs[p].sample;
      path.suffix = Rgb(1);
      const Shifted white_here = traced.shifted(path, p);
      const Shifted white_there = traced.shifted(path, to);
      path.suffix = Rgb(3, 0.5f, 0);
      const Shifted red_here = traced.shifted(path, p);
      const Shifted red_there = traced.shifted(path, to);
      if (white_here.result != ShiftResult::defined || white_there.result != ShiftResult::defined) continue;
      ++pairs;
      const float quotient = white_there.target / white_here.target;
      EXPECT_NEAR(red_there.target / red_here.target, quotient, 1e-4f * quotient);
      const float of_values = luminance(red_there.value) / luminance(red_here.value);
      coloured += std::fabs(of_values - quotient) > 1e-3f * quotient ? 1 : 0;
    }
  }
  EXPECT_GT(pairs, 30);
  EXPECT_GT(coloured, 3) << "luminances of values have other quotients";
}

/// Each end belongs to paths of its own kind. Else their weights would count paths that no candidate has.
TEST(CachedEnd, DoesNotMixWithOtherEnds) {
  TracedPaths traced = trace("cornell");
  for (const uint32_t p : cached_pixels(traced)) {
    StoredPath path = traced.reservoirs[p].sample;
    if (traced.shifted(path, p).result != ShiftResult::defined) continue;
    path.shape = StoredPath::shape_of(PathEnd::connection, path.length(), path.joint(), false);
    EXPECT_EQ(traced.shifted(path, p).result, ShiftResult::other_end);
  }
  traced.shifter.uses_cells = false;
  int paths = 0;
  for (const uint32_t p : cached_pixels(traced)) {
    const ShiftResult result = traced.shifted(p, p).result;
    EXPECT_NE(result, ShiftResult::defined);
    paths += result == ShiftResult::other_end ? 1 : 0;
  }
  EXPECT_GT(paths, 50);
}

/// Also where the path begins at a mirror.
TEST(CachedEnd, IsTheFirstVertexAfterTheJoint) {
  const TracedPaths traced = trace("cornell-mirror");
  int behind_mirror = 0;
  for (const uint32_t p : cached_pixels(traced)) {
    const StoredPath& path = traced.reservoirs[p].sample;
    EXPECT_EQ(path.length(), path.joint() + 2);
    EXPECT_EQ(path.light, kNoLight);
    behind_mirror += path.joint() > 1 ? 1 : 0;
  }
  EXPECT_GT(behind_mirror, 5);
}

}  // namespace
}  // namespace relume
