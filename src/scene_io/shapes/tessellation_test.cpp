#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "scene_io/shapes/flat_shapes.h"
#include "scene_io/shapes/loop_subdivision.h"
#include "scene_io/shapes/quadrics.h"

namespace relume {
namespace {

double area(const Mesh& mesh) {
  double sum = 0;
  for (const UVec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    sum += 0.5 * static_cast<double>(glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a)));
  }
  return sum;
}

/// Checks that triangles face as their vertices' normals.
void expect_consistent(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const UVec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    const Vec3 face = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GT(glm::dot(face, mesh.normals[t[k]]), 0);
      EXPECT_NEAR(glm::length(mesh.normals[t[k]]), 1, 1e-5);
    }
  }
}

/// Texture coordinates of the vertex nearest to `p`.
Vec2 uv_at(const Mesh& mesh, const Vec3& p) {
  size_t nearest = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    if (glm::distance(mesh.positions[i], p) < glm::distance(mesh.positions[nearest], p) - 1e-5f) nearest = i;
  }
  return mesh.uv0[nearest];
}

void expect_uv(const Mesh& mesh, const Vec3& p, const Vec2& uv) {
  EXPECT_NEAR(glm::distance(uv_at(mesh, p), uv), 0, 0.02) << p.x << " " << p.y << " " << p.z;
}

TEST(Tessellation, SpheresHaveTheirAreaAndParameters) {
  const Mesh full = sphere_mesh({.radius = 2, .z_min = -2, .z_max = 2});
  expect_consistent(full);
  EXPECT_NEAR(area(full) / (16 * M_PI), 1, 2e-3);
  expect_uv(full, {0, 2, 0}, {0.25f, 0.5f});
  expect_uv(full, {std::sqrt(2.0f), 0, std::sqrt(2.0f)}, {0, 0.25f});  // v points down
  const Mesh part = sphere_mesh({.radius = 1, .z_min = -0.5f, .z_max = 0.5f, .phi_max_rad = kPi / 2});
  EXPECT_NEAR(area(part), M_PI / 2, 3e-3);  // Archimedes: 2π r h, a quarter of it
  for (const Vec3& p : part.positions) {
    EXPECT_LE(std::fabs(p.z), 0.50001f);
    EXPECT_GE(std::min(p.x, p.y), -1e-5f);
  }
}

TEST(Tessellation, DisksAndCylinders) {
  const Mesh disk = disk_mesh({.height = 3, .radius = 2, .inner_radius = 1});
  expect_consistent(disk);
  EXPECT_NEAR(area(disk), 3 * M_PI, 1e-2);
  EXPECT_EQ(disk.normals[0], Vec3(0, 0, 1));
  expect_uv(disk, {0, 2, 3}, {0.25f, 1});
  expect_uv(disk, {0, 1, 3}, {0.25f, 0});
  const Mesh cylinder = cylinder_mesh({.radius = 2, .z_min = 1, .z_max = 4, .phi_max_rad = kPi});
  expect_consistent(cylinder);
  EXPECT_NEAR(area(cylinder), 6 * M_PI, 1e-2);
  expect_uv(cylinder, {0, 2, 4}, {0.5f, 0});
}

TEST(Tessellation, Rectangle) {
  const Mesh rectangle = rectangle_mesh();
  expect_consistent(rectangle);
  EXPECT_DOUBLE_EQ(area(rectangle), 4);
  EXPECT_EQ(rectangle.normals[0], Vec3(0, 0, 1));
  expect_uv(rectangle, {1, 1, 0}, {1, 0});
}

TEST(Tessellation, BilinearPatches) {
  const std::array<Vec3, 6> p{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}, {0, 3, 1}, {1, 3, 0}}};
  const std::array<uint32_t, 4> flat{0, 1, 2, 3}, bent{2, 3, 4, 5};
  const Mesh one = bilinear_mesh({.positions = p, .normals = {}, .uv = {}, .patches = {&flat, 1}});
  EXPECT_EQ(one.triangles.size(), 2u);
  EXPECT_DOUBLE_EQ(area(one), 2);
  EXPECT_EQ(one.normals[0], Vec3(0, 0, 1));
  expect_uv(one, {1, 2, 0}, {1, 0});
  const Mesh other = bilinear_mesh({.positions = p, .normals = {}, .uv = {}, .patches = {&bent, 1}});
  expect_consistent(other);
  // The middle of the patch is the mean of the corners.
  EXPECT_EQ(uv_at(other, {0.5f, 2.5f, 0.25f}), Vec2(0.5f, 0.5f));
}

TEST(Tessellation, LoopSubdivisionOfAnOctahedron) {
  const std::array<Vec3, 6> p{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  const std::array<UVec3, 8> t{
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  const Mesh mesh = loop_subdivided(p, t, 4);
  EXPECT_EQ(mesh.triangles.size(), 8u * 256);
  expect_consistent(mesh);
  // Valence 4: β = 3/32, limit weight 1 / (4 + 4); the neighbours of (1, 0, 0) cancel, so its limit is 1 - 4/8.
  EXPECT_NEAR(mesh.positions[0].x, 0.5f, 1e-5);
  EXPECT_LE(loop_subdivided(p, t, 1000).triangles.size(), kMaxSubdivided);
}

TEST(Tessellation, LoopSubdivisionKeepsBoundaryCurves) {
  const std::array<Vec3, 4> p{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  const std::array<UVec3, 2> t{{{0, 1, 2}, {0, 2, 3}}};
  const Mesh mesh = loop_subdivided(p, t, 3);
  // A cubic B-spline: the limit of a corner is (1 · a + 4 · p + 1 · b) / 6.
  EXPECT_NEAR(mesh.positions[1].x, 5.0f / 6, 1e-5);
  EXPECT_NEAR(mesh.positions[1].y, 1.0f / 6, 1e-5);
}

}  // namespace
}  // namespace relume
