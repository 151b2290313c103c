#include "techniques/spatial/hash_grid/cell_key.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "testing/random.h"

namespace relume {
namespace {

/// A camera at the origin whose pixels are 1/1000 rad wide.
CellKeys keys() {
  CellKeys k;
  k.cone_spread = 1e-3f;
  k.cell_size = 8;
  return k;
}

CellPoint at(const Vec3& position, const Vec3& normal = Vec3(0, 1, 0)) {
  return {position, CellKeys::bins(normal, 2), 0, 0};
}

bool same(const CellAddress& a, const CellAddress& b) {
  return a.fingerprint == b.fingerprint && a.bucket_hash == b.bucket_hash;
}

TEST(CellKey, CellsGrowWithTheFootprint) {
  const CellKeys k = keys();
  for (const float distance : {0.01f, 1.0f, 10.0f, 5000.0f}) {
    const float edge = std::exp2(static_cast<float>(k.level_of_detail(Vec3(0, 0, distance))));
    const float pixels = edge / (distance * 1e-3f);
    EXPECT_GE(pixels, 8.0f / std::sqrt(2.0f) * 0.999f);
    EXPECT_LE(pixels, 8.0f * std::sqrt(2.0f) * 1.001f);
    EXPECT_EQ(k.level_of_detail(Vec3(0, 0, 2 * distance)), k.level_of_detail(Vec3(0, 0, distance)) + 1);
  }
  EXPECT_EQ(k.level_of_detail(Vec3(0)), kMinCellLevel);
}

TEST(CellKey, OrthographicCamerasSeeOneLevel) {
  CellKeys k = keys();
  k.cone_spread = 0;
  k.cone_width = 0.01f;
  EXPECT_EQ(k.level_of_detail(Vec3(0, 0, 1)), k.level_of_detail(Vec3(0, 0, 1000)));
}

TEST(CellKey, JitterStaysInTheTangentPlaneAndWithinHalfACell) {
  const CellKeys k = keys();
  testing::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = glm::normalize(Vec3(random.next(), random.next(), random.next()) - 0.5f);
    const Vec3 p = 20.0f * Vec3(random.next(), random.next(), random.next());
    const float edge = std::exp2(static_cast<float>(k.level_of_detail(p)));
    const Vec2 u(random.next(), random.next());
    const Vec3 moved = k.jittered(p, n, u) - p;
    EXPECT_LE(std::fabs(glm::dot(moved, n)), 1e-5f);                       // rounding error of coordinates up to 20
    EXPECT_NEAR(glm::length(moved), edge * glm::length(u - 0.5f), 1e-5f);  // uniform in the square if u is
  }
  CellKeys still = k;
  still.jitter = false;
  EXPECT_EQ(still.jittered(Vec3(1, 2, 3), Vec3(0, 1, 0), {0.9f, 0.1f}), Vec3(1, 2, 3));
}

TEST(CellKey, SeparatesIncompatiblePoints) {
  const CellKeys k = keys();
  const CellPoint p = at(Vec3(1.03f, 0, 5));
  EXPECT_TRUE(same(k.address(p), k.address(p)));
  const CellAddress other_side = k.address(at(p.position, Vec3(0, -1, 0)));
  EXPECT_NE(other_side.fingerprint, k.address(p).fingerprint);
  EXPECT_EQ(other_side.bucket_hash, k.address(p).bucket_hash);  // neighbouring slots
  EXPECT_FALSE(same(k.address(at(p.position + Vec3(0.1f, 0, 0))), k.address(p)));
  CellPoint layered = p;
  layered.layer = 3;
  EXPECT_FALSE(same(k.address(layered), k.address(p)));
  for (int coarser = 1; coarser <= 3; ++coarser) {
    EXPECT_NE(k.address(p, coarser).fingerprint, k.address(p).fingerprint);
    EXPECT_NE(k.address(p, coarser).bucket_hash, k.address(p).bucket_hash);  // the level is in both hashes
  }
}

TEST(CellKey, DirectionsSeparateCellsOnRequest) {
  const CellKeys k = [] {
    CellKeys with = keys();
    with.direction_bins = 4;
    return with;
  }();
  SurfacePoint a;
  a.position = Vec3(1, 0, 5);
  a.ng = a.frame.n = Vec3(0, 1, 0);
  a.wo = Vec3(0, 1, 0);
  SurfacePoint b = a;
  b.wo = glm::normalize(Vec3(1, 0.2f, 0));
  const auto address = [](const CellKeys& of, const SurfacePoint& sp, bool directional) {
    return of.address(of.point(sp, Vec2(0.5f), 0, directional));
  };
  EXPECT_TRUE(same(address(k, a, false), address(k, b, false)));
  EXPECT_NE(address(k, a, true).fingerprint, address(k, b, true).fingerprint);
  EXPECT_EQ(address(k, a, true).bucket_hash, address(k, b, true).bucket_hash);
  CellKeys without = k;
  without.direction_bins = 0;
  EXPECT_TRUE(same(address(without, a, true), address(without, b, true)));
}

TEST(CellKey, RoughnessSeparatesCellsOnRequest) {
  CellKeys k = keys();
  SurfacePoint sp{};
  sp.position = Vec3(1, 0, 5);
  sp.ng = sp.frame.n = sp.wo = Vec3(0, 1, 0);
  const auto address = [&](float roughness, bool directional = false, uint16_t coarsening = 0) {
    return k.address(k.point(sp, Vec2(0.5f), 0, directional, coarsening, roughness));
  };
  EXPECT_TRUE(same(address(0.2f), address(1)));
  k.roughness_bins = 4;
  EXPECT_TRUE(same(address(0.9f), address(1)));  // both are nearer to 1 than to 3/4
  EXPECT_NE(address(0.2f).fingerprint, address(1).fingerprint);
  EXPECT_NE(address(0).fingerprint, address(0.2f).fingerprint);
  EXPECT_EQ(address(0.2f).bucket_hash, address(1).bucket_hash);
  EXPECT_NE(address(0.2f, false, 1).fingerprint, address(1, false, 1).fingerprint);
  // The largest numbers of steps neither overlap with each other nor with the flag of coarsened cells.
  k.roughness_bins = 16;
  k.direction_bins = 16;
  EXPECT_NE(address(0, true).fingerprint, address(1, true).fingerprint);
  EXPECT_NE(address(1, true).fingerprint, address(1, true, 1).fingerprint);
  EXPECT_EQ(k.point(sp, Vec2(0.5f), 0, true, 0, 1).direction >> kNormalBits, 17u);
}

TEST(CellKey, WallsAtRoundCoordinatesAreNotTorn) {
  const CellKeys k = keys();
  for (const float height : {0.0f, 1.0f, 2.0f, -4.0f, 0.5f}) {
    for (const float distance : {1.0f, 4.0f, 16.0f, 64.0f}) {
      const Vec3 p(0.37f * distance, height, distance);
      const float noise = 4e-7f * relume::max(1.0f, distance);
      EXPECT_TRUE(same(k.address(at(p + Vec3(0, noise, 0))), k.address(at(p - Vec3(0, noise, 0)))))
          << height << " " << distance;
    }
  }
}

TEST(CellKey, EveryPointOfAFlatPatchIsInOneOfFewCells) {
  // 64 × 64 pixels of a plane seen head-on: 4 to 12 cells per side, and one more for cells cut by the border.
  const CellKeys k = keys();
  std::set<uint64_t> cells;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec3 p(static_cast<float>(x) * 1e-3f, static_cast<float>(y) * 1e-3f, 1.0f);
      cells.insert(k.address(at(p, Vec3(0, 0, -1))).fingerprint);
    }
  }
  EXPECT_GE(cells.size(), 25u);
  EXPECT_LE(cells.size(), 169u);
}

TEST(CellKey, CoarsenedPointsShareLargerCells) {
  CellKeys k = keys();
  k.jitter = false;
  SurfacePoint sp{};
  sp.ng = Vec3(0, 0, -1);
  std::set<uint64_t> cells[3];
  for (int i = 0; i < 64 * 64; ++i) {
    sp.position = Vec3(static_cast<float>(i % 64) * 1e-3f, static_cast<float>(i / 64) * 1e-3f, 1.0f);
    // A normal map, which only fine cells distinguish.
    sp.frame = make_frame(glm::normalize(Vec3(i % 2 == 0 ? 0.4f : -0.4f, 0, -1)));
    for (uint16_t coarsening = 0; coarsening < 3; ++coarsening) {
      const CellPoint p = k.point(sp, Vec2(0.5f), 2, false, coarsening);
      EXPECT_EQ(k.level_of(p), k.level_of_detail(sp.position) + coarsening);
      cells[coarsening].insert(k.address(p).fingerprint);
    }
  }
  EXPECT_GT(cells[0].size(), 5 * cells[1].size());
  EXPECT_GT(cells[1].size(), 2 * cells[2].size());
}

TEST(CellKey, CoarsenedCellsDifferFromCellsOfTheirLevel) {
  const CellKeys k = keys();
  CellPoint near{Vec3(0.1f, 0.2f, 1), 7, 0, 2, 0};
  CellPoint coarsened = near;
  coarsened.coarsening = 1;
  const int level = k.level_of(near);
  EXPECT_NE(k.address_at(near.position, near, level, 0).fingerprint,
            k.address_at(near.position, coarsened, level, 0).fingerprint);
  EXPECT_EQ(k.address_at(near.position, near, level, 0).bucket_hash,
            k.address_at(near.position, coarsened, level, 0).bucket_hash);
}

TEST(CellKey, ResolvesCellsFarFromTheOrigin) {
  CellKeys k = keys();
  k.camera = Vec3(1e6f, 0, 1e6f);
  const CellAddress here = k.address(at(k.camera + Vec3(0, 0, 1)));
  EXPECT_FALSE(same(here, k.address(at(k.camera + Vec3(1, 0, 1)))));
}

TEST(CellKey, IsDefinedForAllNumbers) {
  const CellKeys k = keys();
  constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
  constexpr float kMost = std::numeric_limits<float>::max();
  EXPECT_EQ(CellKeys::bins(Vec3(kNotANumber), 2), CellKeys::bins(Vec3(-kInfinity), 2));
  EXPECT_EQ(CellKeys::bins(Vec3(-5), 2), CellKeys::bins(Vec3(-1), 2));
  EXPECT_EQ(CellKeys::bins(Vec3(kInfinity), 2), CellKeys::bins(Vec3(kMost), 2));
  // With the finest cells, numbers of cells exceed 64 bits.
  const CellPoint p = at(Vec3(0));
  const auto address = [&](double x) { return k.address_at(glm::dvec3(x), p, kMinCellLevel, 0); };
  EXPECT_TRUE(same(address(1e12), address(static_cast<double>(kMost))));
  EXPECT_TRUE(same(address(-1e12), address(-static_cast<double>(kInfinity))));
  EXPECT_TRUE(same(address(-1e12), address(static_cast<double>(kNotANumber))));
  EXPECT_FALSE(same(address(-1e12), address(1e12)));
}

}  // namespace
}  // namespace relume
