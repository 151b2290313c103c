// Updates of the BVH: deformed meshes and moving instances.
#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "accel/bvh/bvh_accel.h"
#include "accel/testing/exhaustive_rays.h"

namespace relume {
namespace {

using testing::corners_of;
using testing::expect_exhaustive_hit;
using testing::kRayId;
using testing::Random;
using testing::random_triangles;
using testing::ray_through;
using testing::Soup;

/// A wavy sheet of edge² quadrilaterals at a moment.
void shape_sheet(std::vector<Vec3>& vertices, uint32_t edge, float moment) {
  for (uint32_t i = 0; i < (edge + 1) * (edge + 1); ++i) {
    const float x = static_cast<float>(i % (edge + 1)) / static_cast<float>(edge);
    const float y = static_cast<float>(i / (edge + 1)) / static_cast<float>(edge);
    vertices[i] = {4 * x, 4 * y + moment * std::sin(9 * x), std::sin(7 * x + moment) * std::cos(5 * y) * moment};
  }
}

/// Adds a deforming mesh for shape_sheet().
void add_sheet(Soup& soup, uint32_t edge) {
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < edge * edge; ++i) {
    const uint32_t corner = i / edge * (edge + 1) + i % edge;
    for (const uint32_t offset : {0u, 1u, edge + 2, 0u, edge + 2, edge + 1}) indices.push_back(corner + offset);
  }
  soup.add_mesh(std::vector<Vec3>((edge + 1) * (edge + 1)), std::move(indices));
  soup.meshes.back().deforms = true;
  shape_sheet(soup.vertices(static_cast<uint32_t>(soup.meshes.size() - 1)), edge, 0);
}

/// A sheet that deforms, in world space and as an instance, beside a wall that does not.
Soup deforming_scene(uint32_t edge) {
  Soup soup;
  add_sheet(soup, edge);
  soup.add_instance(0);
  soup.add_instance(0, glm::rotate(glm::translate(Mat4(1), Vec3(-2, 1, 3)), 1.0f, Vec3(0, 1, 0)));
  soup.add_instance(soup.add_mesh({Vec3(-9, -9, -5), Vec3(9, -9, -5), Vec3(0, 9, -5)}));
  return soup;
}

TEST(BvhUpdate, RefitsDeformingMeshes) {
  constexpr uint32_t kEdge = 20;
  Soup soup = deforming_scene(kEdge);
  BvhAccel accel(soup.meshes, soup.instances, soup.opacity);
  Random random(51);
  // The last moments are so different that the tree is built again.
  for (const float moment : {0.1f, 0.5f, 0.0f, 2.0f, 30.0f, 1.0f}) {
    shape_sheet(soup.vertices(0), kEdge, moment);
    const uint32_t deformed = 0;
    accel.update(soup.instances, {&deformed, 1});
    const BvhAccel rebuilt(soup.meshes, soup.instances, soup.opacity);
    const std::vector<Vec3> corners = corners_of(soup);
    for (int i = 0; i < 1000; ++i) {
      const Ray ray = ray_through(random, corners, 6);
      ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << moment << ", ray " << i;
      ASSERT_EQ(intersect(rebuilt.view(), ray, kRayId).t, intersect(accel.view(), ray, kRayId).t);
    }
  }
}

/// Some meshes change little, and their trees are refitted; others change so much that their trees are built again.
TEST(BvhUpdate, FollowsSeveralDeformingMeshes) {
  constexpr uint32_t kEdge = 12;
  constexpr uint32_t kSheets = 6;
  Soup soup;
  for (uint32_t sheet = 0; sheet < kSheets; ++sheet) {
    add_sheet(soup, kEdge);
    soup.add_instance(sheet, glm::translate(Mat4(1), Vec3(0, 0, sheet)));
  }
  BvhAccel accel(soup.meshes, soup.instances, soup.opacity);
  const size_t bytes = accel.memory_bytes();
  Random random(91);
  std::vector<uint32_t> deformed(kSheets);
  for (uint32_t sheet = 0; sheet < kSheets; ++sheet) deformed[sheet] = sheet;
  for (int frame = 0; frame < 12; ++frame) {
    for (const uint32_t sheet : deformed)
      shape_sheet(soup.vertices(sheet), kEdge, sheet % 2 ? 0.1f * random.uniform() : std::exp2(random.uniform(-4, 6)));
    accel.update(soup.instances, deformed);
    const std::vector<Vec3> corners = corners_of(soup);
    for (int i = 0; i < 300; ++i) {
      const Ray ray = ray_through(random, corners, 8);
      ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << frame << ", ray " << i;
    }
  }
  EXPECT_LT(accel.memory_bytes(), 4 * bytes) << "room of replaced trees is used again";
}

TEST(BvhUpdate, FollowsInstancesThatMove) {
  Random random(61);
  Soup soup;
  const uint32_t mesh = soup.add_mesh(random_triangles(random, 30, 1, 1));
  soup.add_instance(soup.add_mesh(random_triangles(random, 60, 5, 1)));
  for (int i = 0; i < 10; ++i) soup.add_instance(mesh, Mat4(1));
  BvhAccel accel(soup.meshes, soup.instances, soup.opacity);
  for (int frame = 0; frame < 10; ++frame) {
    for (size_t i = 1; i < soup.instances.size(); ++i) {
      soup.instances[i].to_world = glm::translate(Mat4(1), random.point(-5, 5));
      soup.instances[i].visible = random.bits() % 4 != 0;
    }
    accel.update(soup.instances, {});
    const std::vector<Vec3> corners = corners_of(soup);
    for (int i = 0; i < 500; ++i) {
      const Ray ray = ray_through(random, corners, 8);
      ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << frame << ", ray " << i;
    }
  }
}

}  // namespace
}  // namespace relume
