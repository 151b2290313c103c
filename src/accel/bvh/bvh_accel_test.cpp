#include "accel/bvh/bvh_accel.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "accel/bvh/box_ray.h"
#include "accel/testing/exhaustive_rays.h"

namespace relume {
namespace {

using testing::corners_of;
using testing::expect_exhaustive_hit;
using testing::Random;
using testing::random_triangles;
using testing::ray_through;
using testing::Soup;

void expect_exhaustive_hits(const Soup& soup, uint32_t seed, int rays, float extent) {
  const BvhAccel accel(soup.meshes, soup.instances, soup.opacity);
  const std::vector<Vec3> corners = corners_of(soup);
  Random random(seed);
  for (int i = 0; i < rays; ++i) {
    const Ray ray = ray_through(random, corners, extent);
    ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << "seed " << seed << ", ray " << i;
  }
}

TEST(BvhAccel, FindsTheHitsOfAnExhaustiveSearch) {
  for (uint32_t seed = 0; seed < 8; ++seed) {
    Random random(seed);
    Soup soup;
    soup.add_instance(soup.add_mesh(random_triangles(random, 40 << seed % 4, 10, seed % 2 ? 1.0f : 8.0f)));
    expect_exhaustive_hits(soup, seed, 3000, 12);
  }
}

TEST(BvhAccel, FindsHugeAndTinyTriangles) {
  for (const float size : {1e-6f, 1e-3f, 1e3f, 1e6f, 1e9f}) {
    Random random(3);
    Soup soup;
    std::vector<Vec3> corners = random_triangles(random, 100, 1, 1);
    for (const Vec3& corner : random_triangles(random, 20, size, size)) corners.push_back(corner);
    soup.add_instance(soup.add_mesh(corners));
    expect_exhaustive_hits(soup, 4, 4000, 2);
    expect_exhaustive_hits(soup, 5, 4000, size);
  }
}

TEST(BvhAccel, FindsNeedlesAndDegenerateTriangles) {
  Random random(11);
  Soup soup;
  std::vector<Vec3> corners;
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = random.point(-10, 10);
    const Vec3 along = random.direction() * random.uniform(1, 20);
    const float width = std::pow(10.0f, random.uniform(-9, -1));
    corners.insert(corners.end(), {a, a + along, a + along * random.uniform(-1, 2) + random.direction() * width});
    if (i % 10 == 0) corners.insert(corners.end(), {a, a, a + along});  // no area
    if (i % 10 == 1) corners.insert(corners.end(), {a, a + along, a + 2.0f * along});
    if (i % 10 == 2) corners.insert(corners.end(), {a, a, a});
  }
  corners.insert(corners.end(), {Vec3(0), Vec3(std::numeric_limits<float>::quiet_NaN()), Vec3(1)});
  corners.insert(corners.end(), {Vec3(0), Vec3(kInfinity, 0, 0), Vec3(1)});
  soup.add_instance(soup.add_mesh(corners));
  expect_exhaustive_hits(soup, 12, 20000, 12);
}

/// Instances of two meshes; with odd seeds, of a third one that is not transformed.
void expect_hits_of_instances(uint32_t first_seed, uint32_t seeds) {
  for (uint32_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    Random random(100 + seed);
    Soup soup;
    const uint32_t first = soup.add_mesh(random_triangles(random, 60, 1, 0.5f));
    const uint32_t second = soup.add_mesh(random_triangles(random, 1, 1, 2));
    const uint32_t still = soup.add_mesh(random_triangles(random, 60, 10, 2));
    if (seed % 2) soup.add_instance(still);
    for (int i = 0; i < 30; ++i) {
      Mat4 to_world = glm::translate(Mat4(1), random.point(-10, 10));
      to_world = glm::rotate(to_world, random.uniform(0, 6), random.direction());
      // Mirrored, stretched, and nearly flat ones.
      const float flat = i % 7 == 0 ? 1e-5f : 1.0f;
      to_world = glm::scale(to_world, random.point(0.1f, 3) * Vec3(i % 2 ? 1 : -1, flat, 1));
      soup.add_instance(i % 3 ? first : second, to_world);
      soup.instances.back().visible = i % 5 != 0;
    }
    soup.add_instance(first, glm::scale(Mat4(1), Vec3(0)));
    expect_exhaustive_hits(soup, seed, 4000, 14);
  }
}
TEST(BvhAccel, FindsInstances) { expect_hits_of_instances(0, 4); }
TEST(SlowBvhAccel, FindsInstancesOfMoreSeeds) { expect_hits_of_instances(4, 4); }

/// Rays along an axis, at the borders of the boxes of a flat grid whose instance is a thousandth to a ten-millionth as
/// wide in one direction as in the others.
TEST(BvhAccel, FindsGridsThatAreSquashed) {
  constexpr uint32_t kEdge = 12;
  for (const float width : {1e-3f, 1e-5f, 1e-6f, 1e-7f}) {
    for (int axis = 0; axis < 3; ++axis) {
      Soup soup;
      std::vector<Vec3> corners;
      const auto vertex = [&](uint32_t i, uint32_t k) {
        Vec3 p(0);
        p[(axis + 1) % 3] = static_cast<float>(i) / kEdge;
        p[(axis + 2) % 3] = static_cast<float>(k) / kEdge;
        return p;
      };
      for (uint32_t i = 0; i < kEdge * kEdge; ++i) {
        const uint32_t x = i % kEdge;
        const uint32_t y = i / kEdge;
        for (const Vec3& p : {vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y), vertex(x + 1, y + 1),
                              vertex(x, y + 1)})
          corners.push_back(p);
      }
      Vec3 scale(1);
      scale[axis] = width;
      soup.add_instance(soup.add_mesh(corners), glm::scale(Mat4(1), scale));
      const BvhAccel accel(soup.meshes, soup.instances, {});
      Random random(71);
      for (int i = 0; i < 4000; ++i) {
        Ray ray{vertex(random.bits() % kEdge, random.bits() % kEdge), Vec3(0), kInfinity};
        const float distance = std::pow(10.0f, random.uniform(-1, 2));
        ray.origin += random.point(-1e-4f, 1e-4f);
        ray.origin[axis] = -distance;
        ray.direction[axis] = 1;
        ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << width << " " << axis << " " << i;
      }
    }
  }
}

TEST(BvhAccel, FormsOfTheBoxTestAgree) {
  Random random(81);
  for (int i = 0; i < 20000; ++i) {
    BvhNode node;
    for (uint32_t child = 0; child < kBvhWidth; ++child) {
      const Vec3 a = random.point(-2, 2);
      const Vec3 b = random.point(-2, 2);
      const bool empty = random.bits() % 5 == 0;
      for (int axis = 0; axis < 3; ++axis) {
        node.bounds[2 * axis][child] = empty ? kInfinity : min(a[axis], b[axis]);
        node.bounds[2 * axis + 1][child] = empty ? -kInfinity : max(a[axis], b[axis]);
      }
    }
    Vec3 direction = random.direction();
    if (i % 4 == 0) direction[static_cast<int>(random.bits() % 3)] = 0;
    const BoxRay ray(random.point(-3, 3), direction, Vec3(kBoxMargin), 3, 1);
    const float t_max = i % 3 == 0 ? random.uniform(0, 4) : kInfinity;
    float entries[2][kBvhWidth];
    const uint32_t entered = ray.enter_one_by_one(node, t_max, entries[0]);
    ASSERT_EQ(ray.enter_at_once(node, t_max, entries[1]), entered) << i;
    for (uint32_t child = 0; child < kBvhWidth; ++child) {
      ASSERT_EQ(entries[0][child], entries[1][child]) << i;
      ASSERT_EQ(ray.enters(node, child, t_max), (entered >> child & 1u) != 0) << i;
    }
  }
}

/// Far from the origin, the rounding of coordinates exceeds the size of details. `rays`: at each distance.
void expect_hits_far_away(int rays) {
  for (const float distance : {1e3f, 1e5f, 1e7f}) {
    Random random(9);
    Soup soup;
    const uint32_t mesh = soup.add_mesh(random_triangles(random, 60, 1, 1));
    const Vec3 center = random.direction() * distance;
    for (int i = 0; i < 5; ++i) {
      const Mat4 placed = glm::translate(Mat4(1), center + random.point(-2, 2));
      soup.add_instance(mesh, glm::rotate(placed, random.uniform(0, 6), random.direction()));
    }
    const BvhAccel accel(soup.meshes, soup.instances, {});
    const std::vector<Vec3> corners = corners_of(soup);
    for (int i = 0; i < rays; ++i) {
      Ray ray = ray_through(random, corners, distance);
      if (i % 2) {
        ray.origin = center + random.point(-5, 5);
        ray.direction = random.direction();
      }
      ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << distance << ", ray " << i;
    }
  }
}
/// 18,000 rays detect a fault of one ray in 4,000 with a probability of 99 %.
TEST(BvhAccel, FindsInstancesFarAway) { expect_hits_far_away(6000); }
TEST(SlowBvhAccel, FindsInstancesFarAway) { expect_hits_far_away(20000); }

void expect_filtered_hits(int rays) {
  Random random(21);
  Soup soup;
  for (int i = 0; i < 4; ++i) {
    soup.add_mesh(random_triangles(random, 100, 5, 2));
    soup.meshes.back().needs_opacity = i % 2 == 1;
    soup.meshes.back().culls_back_faces = i >= 2;
    soup.add_instance(static_cast<uint32_t>(i));
    soup.add_instance(static_cast<uint32_t>(i), glm::scale(Mat4(1), Vec3(-1, 1, 1)));
  }
  soup.opacity.function = [](const void*, uint32_t, uint32_t primitive, float u, float v) {
    return primitive % 3 == 0 ? 0.5f : (u > v ? 1.0f : 0.0f);
  };
  expect_exhaustive_hits(soup, 22, rays, 6);
}
TEST(BvhAccel, FiltersByOpacityAndSide) { expect_filtered_hits(8000); }
TEST(SlowBvhAccel, FiltersByOpacityAndSide) { expect_filtered_hits(20000); }

TEST(BvhAccel, AnswersForEmptyScenes) {
  Soup soup;
  expect_exhaustive_hits(soup, 1, 10, 1);
  soup.add_instance(soup.add_mesh({}));
  soup.add_instance(0, Mat4(1));
  expect_exhaustive_hits(soup, 1, 10, 1);
  soup.add_instance(soup.add_mesh({Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)}));
  expect_exhaustive_hits(soup, 1, 1000, 1);
}

TEST(BvhAccel, SurvivesRaysThatAreNotFinite) {
  Random random(31);
  Soup soup;
  soup.add_instance(soup.add_mesh(random_triangles(random, 100, 1, 1)));
  const BvhAccel accel(soup.meshes, soup.instances, {});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float x : {nan, kInfinity, -kInfinity, 1e30f}) {
    for (int k = 0; k < 7; ++k) {
      Ray ray{Vec3(0), glm::normalize(Vec3(1, 2, 3)), kInfinity};
      if (k < 3) ray.origin[k] = x;
      if (k >= 3 && k < 6) ray.direction[k - 3] = x;
      if (k == 6) ray.t_max = -std::fabs(x);
      EXPECT_FALSE(intersect(accel.view(), ray, 0).valid());
      EXPECT_FALSE(occluded(accel.view(), ray, 0));
    }
  }
  EXPECT_FALSE(intersect(accel.view(), {Vec3(0), Vec3(0), kInfinity}, 0).valid());
}

TEST(BvhAccel, AcceptsAMillionCoincidentTriangles) {
  constexpr uint32_t kCount = 1'000'000;
  Soup soup;
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < kCount; ++i) indices.insert(indices.end(), {0, 1, 2});
  soup.add_mesh({Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)}, std::move(indices));
  soup.add_instance(0);
  const BvhAccel accel(soup.meshes, soup.instances, {});
  const Hit hit = intersect(accel.view(), {Vec3(0, 0, 1), Vec3(0, 0, -1), kInfinity}, 0);
  EXPECT_EQ(hit.primitive, 0u);
  EXPECT_EQ(hit.t, 1.0f);
  EXPECT_FALSE(intersect(accel.view(), {Vec3(2, 0, 1), Vec3(0, 0, -1), kInfinity}, 0).valid());
}

/// A closed mesh: a sphere of `rings`² quadrilaterals, as an instance or in world space.
Soup closed_mesh(uint32_t rings, const Mat4& to_world, bool instanced) {
  std::vector<Vec3> vertices;
  std::vector<uint32_t> indices;
  const uint32_t around = 2 * rings;
  for (uint32_t i = 0; i <= rings; ++i) {
    for (uint32_t k = 0; k < around; ++k) {
      const float theta = 3.14159265f * static_cast<float>(i) / static_cast<float>(rings);
      const float phi = 6.2831853f * static_cast<float>(k) / static_cast<float>(around);
      const Vec3 p(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      vertices.push_back(i == 0 ? Vec3(0, 1, 0) : (i == rings ? Vec3(0, -1, 0) : p));
      if (!instanced) vertices.back() = transform_point(to_world, vertices.back());
      const uint32_t next = (k + 1) % around;
      if (i == rings) continue;
      for (const uint32_t index : {i * around + k, i * around + next, (i + 1) * around + next, i * around + k,
                                   (i + 1) * around + next, (i + 1) * around + k})
        indices.push_back(index);
    }
  }
  Soup soup;
  soup.add_mesh(std::move(vertices), std::move(indices));
  if (instanced) {
    soup.add_instance(0, to_world);
  } else {
    soup.add_instance(0);
  }
  return soup;
}

TEST(BvhAccel, ClosedMeshesAreWatertight) {
  for (const bool instanced : {false, true}) {
    Random random(41);
    const Mat4 to_world = glm::scale(glm::rotate(glm::translate(Mat4(1), Vec3(30, -4, 7)), 0.7f, Vec3(0.6f, 0, 0.8f)),
                                     Vec3(3, 0.5f, 1.7f));
    const Soup soup = closed_mesh(24, to_world, instanced);
    const BvhAccel accel(soup.meshes, soup.instances, {});
    const std::vector<Vec3> corners = corners_of(soup);
    for (int i = 0; i < 200000; ++i) {
      const Vec3 origin = transform_point(to_world, random.direction() * random.uniform(0, 0.8f));
      const size_t triangle = 3 * (random.bits() % (corners.size() / 3));
      const Vec3 a = corners[triangle];
      const Vec3 b = corners[triangle + 1];
      const Vec3 target = i % 3 == 0 ? a : (i % 3 == 1 ? 0.5f * (a + b) : a + (b - a) * random.uniform());
      const Ray ray{origin, glm::normalize(target - origin), kInfinity};
      ASSERT_TRUE(intersect(accel.view(), ray, 0).valid()) << i;
      ASSERT_TRUE(occluded(accel.view(), ray, 0)) << i;
    }
  }
}

/// Triangles that shrink towards a point make deep trees.
TEST(BvhAccel, FindsTrianglesOfManySizes) {
  Soup soup;
  std::vector<Vec3> corners;
  float size = 1e9f;
  for (int i = 0; i < 200; ++i) {
    for (int copy = 0; copy < 100; ++copy)
      corners.insert(corners.end(), {Vec3(size), Vec3(2 * size, size, size), Vec3(size, 2 * size, size)});
    size *= 0.75f;
  }
  soup.add_instance(soup.add_mesh(corners));
  const BvhAccel accel(soup.meshes, soup.instances, {});
  Random random(101);
  for (int i = 0; i < 200; ++i) {
    const float at = 1e9f * std::pow(0.75f, random.uniform(0, 200)) * random.uniform(0.9f, 1.5f);
    const Ray ray{Vec3(at * 1.1f, at * 1.2f, -5), Vec3(0, 0, 1), kInfinity};
    ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(soup, accel.view(), ray)) << i;
  }
}

}  // namespace
}  // namespace relume
