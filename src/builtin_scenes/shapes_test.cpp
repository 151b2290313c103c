#include "builtin_scenes/shapes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "builtin_scenes/rooms.h"

namespace relume {
namespace {

float area(const Mesh& mesh) {
  float sum = 0;
  for (const UVec3& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t.x];
    sum += 0.5f * glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
  }
  return sum;
}

/// Signed volume by the divergence theorem; positive if the triangles face outwards. Only for closed meshes.
float volume(const Mesh& mesh) {
  double sum = 0;
  for (const UVec3& t : mesh.triangles)
    sum += static_cast<double>(glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z]))) / 6;
  return static_cast<float>(sum);
}

void expect_consistent(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.uv0.size(), mesh.positions.size());
  for (const UVec3& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t.x];
    const Vec3 cross = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    for (const uint32_t i : {t.x, t.y, t.z}) ASSERT_GT(glm::dot(cross, mesh.normals[i]), 0);
  }
}

TEST(Shapes, Quad) {
  const Mesh mesh = quad({1, 2, 3}, {2, 0, 0}, {0, 3, 0});
  expect_consistent(mesh);
  EXPECT_FLOAT_EQ(area(mesh), 6);
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
}

TEST(Shapes, Box) {
  const Mesh mesh = box({-1, 0, 2}, {1, 3, 6});
  expect_consistent(mesh);
  EXPECT_FLOAT_EQ(area(mesh), 2 * (2 * 3 + 3 * 4 + 2 * 4));
  EXPECT_FLOAT_EQ(volume(mesh), 24);
}

TEST(Shapes, SpheresAreInscribed) {
  const float exact = 4.0f / 3 * kPi * 8;
  const Mesh mesh = icosphere(2, 4);
  expect_consistent(mesh);
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(glm::length(p), 2, 1e-5f);  // float rounding
  EXPECT_LT(volume(mesh), exact);
  EXPECT_GT(volume(mesh), 0.99f * exact);  // facets of about 4 degrees lose less than 1 %
  EXPECT_EQ(mesh.triangles.size(), 20u * 256);
}

TEST(Shapes, Cylinder) {
  const Mesh mesh = cylinder(0.5f, 2, 256, true);
  expect_consistent(mesh);
  EXPECT_NEAR(volume(mesh), kPi * 0.25f * 2, 1e-3f);  // 256 facets lose 1e-4 of the area
}

TEST(Shapes, LatheClosedOnTheAxis) {
  const Mesh mesh = lathe({{0, 0}, {1, 0}, {1, 2}, {0, 3}}, 128);
  expect_consistent(mesh);
  EXPECT_NEAR(volume(mesh), kPi * (2 + 1.0f / 3), 0.01f);  // cylinder and cone; 128 facets lose 4e-4
}

TEST(Shapes, HeightFieldLooksUp) {
  const Mesh mesh = height_field({0, 0}, {2, 3}, 8, 4, [](float x, float z) { return 0.1f * x * z; });
  expect_consistent(mesh);
  EXPECT_EQ(mesh.triangles.size(), 2u * 8 * 4);
  for (const Vec3& n : mesh.normals) EXPECT_GT(n.y, 0);
}

TEST(Shapes, TorusKnotIsClosed) {
  const Mesh mesh = torus_knot(2, 3, 1, 0.2f, 600, 32);
  expect_consistent(mesh);
  EXPECT_EQ(mesh.triangles.size(), 2u * 600 * 32);
  // Pappus: the tube's cross-section times the length of the curve, approximated by a polygon.
  double length = 0;
  for (size_t j = 0; j < 600; ++j) {
    const auto centre = [&](size_t row) { return mesh.positions[row * 33] - 0.2f * mesh.normals[row * 33]; };
    length += static_cast<double>(glm::distance(centre(j), centre(j + 1)));
  }
  EXPECT_NEAR(volume(mesh) / (kPi * 0.04 * length), 1, 0.01);  // 32 facets lose 0.6 %
}

TEST(Shapes, ParametricSurfaceIsSmoothAcrossItsSeam) {
  const Mesh mesh = parametric_surface(
      64, 8, [](float u, float v) { return Vec3(std::cos(2 * kPi * u), v, -std::sin(2 * kPi * u)); });
  expect_consistent(mesh);
  for (size_t row = 0; row < 9; ++row) {
    EXPECT_EQ(mesh.normals[row * 65], mesh.normals[row * 65 + 64]);
    EXPECT_NEAR(mesh.normals[row * 65].x, 1, 1e-4f);  // by symmetry
  }
}

TEST(Shapes, TransformedKeepsOrientationUnderMirroring) {
  const Mesh mesh = transformed(box(Vec3(0), Vec3(1)), scaling({-2, 3, 4}));
  expect_consistent(mesh);
  EXPECT_FLOAT_EQ(volume(mesh), 24);
  EXPECT_FLOAT_EQ(volume(flipped(mesh)), -24);
}

TEST(Rooms, WallWithOpening) {
  const Mesh mesh = wall({0, 0}, {0, 10}, 0.2f, 3, {{{4, 6}, {0.5f, 2}}});
  expect_consistent(mesh);
  EXPECT_NEAR(volume(mesh), 0.2f * (10 * 3.01f - 2 * 1.5f), 1e-3f);  // from 1 cm below the floor; rounding
  for (const Vec3& p : mesh.positions) {
    EXPECT_NEAR(p.x, 0, 0.101f);
    EXPECT_GE(p.z, -1e-5f);
    EXPECT_LE(p.z, 10.0001f);
  }
}

TEST(Rooms, PlanEnclosesItsOpenCells) {
  FloorPlan plan{{"####", "#ab#", "#a##", "####"}, 2, 3};
  Mesh mesh = plan_floor(plan);
  EXPECT_FLOAT_EQ(area(mesh), 3 * 4);
  append(mesh, plan_ceiling(plan));
  append(mesh, plan_walls(plan, 'a'));
  append(mesh, plan_walls(plan, 'b'));
  expect_consistent(mesh);
  EXPECT_NEAR(volume(mesh), -3 * 4 * 3, 1e-4f);  // negative because it faces inwards
}

}  // namespace
}  // namespace relume
