#include <gtest/gtest.h>

#include <cmath>

#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/spatial/hash_grid/testing/grid_camera.h"

namespace relume {
namespace {

HashGridSettings neighbours_and_coarser() {
  HashGridSettings settings;
  settings.undersampled_cells = UndersampledCells::neighbours_coarser;
  settings.change_detection = 0;
  settings.inherited_count = 0;
  return settings;
}

/// Samples around the centre of a cell on a plane that the camera sees head-on.
class Patch {
 public:
  explicit Patch(const HashGridSettings& settings) : grid_(settings, 1 << 12), backend_(1) {
    const CellKeys keys = view().keys;
    const Vec3 start(0.1f, 0.2f, 2);
    level_ = keys.level_of_detail(start);
    middle_ = Vec3(keys.middle(start, level_));
  }

  HashGridView view() { return grid_.view(grid_camera()); }

  /// The point `x`, `y` cells away from the centre, where the surface has the shading normal `n`.
  CellPoint point(float x, float y, const Vec3& n = Vec3(0, 0, -1)) {
    SurfacePoint sp;
    sp.position = middle_ + std::exp2(static_cast<float>(level_)) * Vec3(x, y, 0);
    sp.ng = Vec3(0, 0, -1);
    sp.frame = make_frame(glm::normalize(n));
    CellKeys keys = view().keys;
    keys.jitter = false;
    return keys.point(sp, Vec2(0.5f), 0, false);
  }

  /// `u`: below 1/2 to add the samples to the next coarser cell, too.
  void add(const CellPoint& p, int count, float value, float u) {
    for (int i = 0; i < count; ++i) view().insert(p, Rgb(value), 1.0f, u);
  }

  CellMoments moments(const CellPoint& p) {
    grid_.end_frame(backend_);
    return view().moments(p);
  }

 private:
  HashGrid grid_;
  Backend backend_;
  int level_ = 0;
  Vec3 middle_{0};
};

/// The point in a cell that has the three cells to its right and above as neighbours.
constexpr float kAside = 0.25f;

TEST(NeighboursAndCoarser, EnoughNeighboursMakeCoarserCellsUnnecessary) {
  Patch patch(neighbours_and_coarser());
  for (const float y : {0.0f, 1.0f}) {
    for (const float x : {0.0f, 1.0f}) patch.add(patch.point(x, y), 2, 1 + x + 2 * y, 0.9f);
  }
  patch.add(patch.point(-1, 0), 7, 100, 0.0f);  // outside of the four cells, but in a coarser one with some of them
  const CellMoments m = patch.moments(patch.point(kAside, kAside));
  EXPECT_EQ(m.count, 8.0f);
  EXPECT_NEAR(m.mean.r, 2.5f, 1e-5f);
}

TEST(NeighboursAndCoarser, FewNeighboursAreJoinedByOneCoarserLevel) {
  Patch patch(neighbours_and_coarser());
  const CellPoint here = patch.point(kAside, kAside);
  patch.add(here, 1, 1, 0.0f);
  const CellMoments m = patch.moments(here);
  EXPECT_EQ(m.count, 2.0f);  // the cell, and the same sample one level higher: no other level is pooled
  HashGridSettings settings = neighbours_and_coarser();
  settings.coarser_levels = 3;
  Patch deeper(settings);
  deeper.add(here, 1, 1, 0.0f);
  EXPECT_EQ(deeper.moments(here).count, 4.0f);
}

TEST(NeighboursAndCoarser, CoarserCellsGetHalfOfTheSamples) {
  HashGridSettings settings = neighbours_and_coarser();
  settings.coarser_levels = 3;
  Patch patch(settings);
  const CellPoint p = patch.point(0, 0);
  constexpr int kSamples = 80000;
  const HashGridView v = patch.view();
  for (uint32_t i = 0; i < kSamples; ++i) v.insert(p, Rgb(1), 1, to_unit_float(hash(i)));
  double expected = kSamples;
  for (int k = 0; k <= 3; ++k, expected *= 0.5) {
    const uint32_t slot = v.find(v.keys.address(p, k));
    ASSERT_NE(slot, kNoCell);
    EXPECT_NEAR(v.sums[slot].count, expected, 5 * std::sqrt(expected) + 1);  // five standard errors
  }
}

TEST(NeighboursAndCoarser, CoarserCellsMixSimilarNormalsButNotOppositeOnes) {
  Patch patch(neighbours_and_coarser());
  const CellKeys keys = patch.view().keys;
  const auto share = [&](const Vec3& a, const Vec3& b, int coarser) {
    return keys.address(patch.point(0, 0, a), coarser).fingerprint ==
           keys.address(patch.point(0, 0, b), coarser).fingerprint;
  };
  const Vec3 up(0, 0, -1);
  const Vec3 bumps[] = {{0.4f, 0, -0.917f}, {-0.4f, 0, -0.917f}, {0, 0.45f, -0.893f}};
  for (const Vec3& bump : bumps) {
    EXPECT_FALSE(share(up, bump, 0));
    EXPECT_TRUE(share(up, bump, 1));
    EXPECT_FALSE(share(bump, -bump, 1));
  }
  EXPECT_FALSE(share(up, -up, 1));
  EXPECT_FALSE(share(up, Vec3(1, 0, 0), 1));
  // With eight steps, the largest halved number, the finest differences still show in the cell alone.
  HashGridSettings fine = neighbours_and_coarser();
  fine.normal_bins = 16;
  Patch finer(fine);
  const auto address = [&](const Vec3& n, int coarser) {
    return finer.view().keys.address(finer.point(0, 0, n), coarser).fingerprint;
  };
  const Vec3 tilted(0.06f, 0, -1);
  EXPECT_NE(address(up, 0), address(tilted, 0));
  EXPECT_EQ(address(up, 1), address(tilted, 1));
  EXPECT_NE(address(up, 1), address(-up, 1));
}

TEST(NeighboursAndCoarser, OtherModesKeepTheirKeys) {
  HashGridSettings settings = neighbours_and_coarser();
  Patch both(settings);
  settings.undersampled_cells = UndersampledCells::coarser;
  Patch coarser(settings);
  const Vec3 n(0.4f, 0, -0.917f);
  const CellAddress a = both.view().keys.address(both.point(0, 0, n));
  const CellAddress b = coarser.view().keys.address(coarser.point(0, 0, n));
  EXPECT_EQ(a.fingerprint, b.fingerprint);
  EXPECT_EQ(a.bucket_hash, b.bucket_hash);
}

TEST(NeighboursAndCoarser, TheWaitingListHasSpaceForCoarserSamples) {
  const auto samples = [](UndersampledCells mode) { return bounds_for(1 << 20, 1, 1 << 30, mode).samples_a_frame; };
  EXPECT_GE(samples(UndersampledCells::neighbours_coarser), uint64_t{2} << 20);
  EXPECT_LT(samples(UndersampledCells::coarser), uint64_t{3} << 19);
}

}  // namespace
}  // namespace relume
