#include "accel/refit_cost.h"

#include <gtest/gtest.h>

#include "core/hash.h"

namespace relume {
namespace {

/// A grid of n × n squares in the plane z = 0, each of two triangles.
struct Grid {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;

  explicit Grid(uint32_t n) {
    for (uint32_t y = 0; y <= n; ++y) {
      for (uint32_t x = 0; x <= n; ++x) positions.emplace_back(x, y, 0);
    }
    for (uint32_t y = 0; y < n; ++y) {
      for (uint32_t x = 0; x < n; ++x) {
        const uint32_t corner = y * (n + 1) + x;
        triangles.emplace_back(corner, corner + 1, corner + n + 1);
        triangles.emplace_back(corner + 1, corner + n + 2, corner + n + 1);
      }
    }
  }

  AccelMesh mesh() const {
    AccelMesh m;
    m.positions = &positions.data()->x;
    m.position_stride = sizeof(Vec3);
    m.vertex_count = positions.size();
    m.indices = &triangles.data()->x;
    m.triangle_count = triangles.size();
    m.deforms = true;
    return m;
  }
};

TEST(RefitCost, KeepsTheBvhWhereNeighboursStayTogether) {
  Grid grid(32);
  RefitCost cost(grid.mesh());
  EXPECT_FALSE(cost.has_grown(grid.mesh()));
  for (Vec3& p : grid.positions) p = Vec3(p.x, p.y, 4 * std::sin(0.2f * p.x));
  EXPECT_FALSE(cost.has_grown(grid.mesh()));
  for (Vec3& p : grid.positions) p = Vec3(-p.y, p.x, p.z) * 3.0f + Vec3(100);
  EXPECT_FALSE(cost.has_grown(grid.mesh()));
}

TEST(RefitCost, HasGrownIfNeighboursSeparate) {
  Grid grid(32);
  RefitCost cost(grid.mesh());
  for (uint32_t i = 0; i < grid.positions.size(); ++i) {
    for (int k = 0; k < 3; ++k) grid.positions[i][k] = 32 * to_unit_float(hash(i, static_cast<uint32_t>(k)));
  }
  EXPECT_TRUE(cost.has_grown(grid.mesh()));
  cost.reset(grid.mesh());
  EXPECT_FALSE(cost.has_grown(grid.mesh()));
}

TEST(RefitCost, AcceptsMeshesWithoutExtent) {
  Grid grid(4);
  RefitCost cost(grid.mesh());
  for (Vec3& p : grid.positions) p = Vec3(1);
  EXPECT_FALSE(cost.has_grown(grid.mesh()));
  AccelMesh empty = grid.mesh();
  empty.triangle_count = 0;
  EXPECT_FALSE(RefitCost(empty).has_grown(empty));
}

}  // namespace
}  // namespace relume
