// Rays through scenes of arbitrary triangles, compared with an exhaustive search.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "accel/bvh/postponed_nodes.h"
#include "accel/bvh/traverse.h"
#include "accel/testing/soup.h"

namespace relume::testing {

inline constexpr uint32_t kRayId = 7;

/// The traversals of device code must return the hits of an exhaustive search, too. `nearest`, `from_camera`: those
/// hits. `to_camera`: whether anything blocks the ray to the camera.
inline void expect_device_hits(const Soup& soup, const AccelView& accel, const Ray& ray, const Hit& nearest,
                               const Hit& from_camera, bool to_camera) {
  const auto opacity = [&](uint32_t instance, uint32_t primitive, float u, float v) {
    return soup.opacity_of(instance, primitive, u, v);
  };
  const Hit hit = bvh_intersect<PostponedNodes>(accel.bvh, ray, kRayId, 0, opacity);
  ASSERT_EQ(hit.instance, nearest.instance);
  ASSERT_EQ(hit.primitive, nearest.primitive);
  ASSERT_EQ(hit.t, nearest.t);
  ASSERT_EQ(hit.u, nearest.u);
  ASSERT_EQ(hit.v, nearest.v);
  ASSERT_EQ(bvh_intersect<PostponedNodes>(accel.bvh, ray, kRayId, kFromCamera, opacity).primitive,
            from_camera.primitive);
  ASSERT_EQ(bvh_occluded<PostponedNodes>(accel.bvh, ray, kRayId, 0, opacity), nearest.valid());
  ASSERT_EQ(bvh_occluded<PostponedNodes>(accel.bvh, ray, kRayId, kToCamera, opacity), to_camera);
}

/// Every query of `accel` must return the hits of an exhaustive search, bit for bit.
inline void expect_exhaustive_hit(const Soup& soup, const AccelView& accel, const Ray& ray) {
  const Hit expected = exhaustive_hit(soup, ray, kRayId);
  const Hit hit = intersect(accel, ray, kRayId);
  ASSERT_EQ(hit.instance, expected.instance);
  ASSERT_EQ(hit.primitive, expected.primitive);
  ASSERT_EQ(hit.t, expected.t);
  ASSERT_EQ(hit.u, expected.u);
  ASSERT_EQ(hit.v, expected.v);
  ASSERT_EQ(occluded(accel, ray, kRayId), expected.valid());
  const Hit from_camera = intersect_from_camera(accel, ray, kRayId);
  const Hit expected_from_camera = exhaustive_hit(soup, ray, kRayId, kFromCamera);
  ASSERT_EQ(from_camera.instance, expected_from_camera.instance);
  ASSERT_EQ(from_camera.primitive, expected_from_camera.primitive);
  const bool to_camera = exhaustive_hit(soup, ray, kRayId, kToCamera).valid();
  ASSERT_EQ(occluded_to_camera(accel, ray, kRayId), to_camera);
  Hit in_packet;
  bool blocked = false;
  intersect_packet(accel, &ray, &kRayId, &in_packet, 1);
  occluded_packet(accel, &ray, &kRayId, &blocked, 1);
  ASSERT_EQ(in_packet.primitive, expected.primitive);
  ASSERT_EQ(in_packet.t, expected.t);
  ASSERT_EQ(blocked, expected.valid());
  if (accel.choice == AccelChoice::bvh) expect_device_hits(soup, accel, ray, expected, expected_from_camera, to_camera);
}

/// All world-space corners of the scene.
inline std::vector<Vec3> corners_of(const Soup& soup) {
  std::vector<Vec3> corners;
  soup.for_each_triangle([&](uint32_t, uint32_t, const Vec3& a, const Vec3& b, const Vec3& c) {
    corners.insert(corners.end(), {a, b, c});
  });
  return corners;
}

/// A ray to a random point, a corner, an edge or a centroid; along an axis through a corner; or within a triangle's
/// plane.
inline Ray ray_through(Random& random, const std::vector<Vec3>& corners, float extent) {
  const Vec3 origin = random.point(-extent, extent);
  const size_t triangle = corners.empty() ? 0 : 3 * (random.bits() % (corners.size() / 3));
  const auto corner = [&](size_t k) { return corners[triangle + k]; };
  Vec3 target = random.point(-extent, extent);
  const uint32_t kind = corners.empty() ? 0 : random.bits() % 6;
  if (kind == 1) target = corner(0);
  if (kind == 2) target = corner(0) + (corner(1) - corner(0)) * random.uniform();
  if (kind == 3) target = (corner(0) + corner(1) + corner(2)) / 3.0f;
  if (kind == 5) {  // within the plane, up to rounding
    const Vec3 start = corner(0) + (corner(0) - corner(1)) * random.uniform(0, 2) * 3.0f;
    target = corner(2) + (corner(1) - corner(2)) * random.uniform();
    if (target != start) return {start, glm::normalize(target - start), kInfinity};
  }
  if (kind == 4) {
    Vec3 axis(0);
    axis[static_cast<int>(random.bits() % 3)] = random.bits() % 2 ? 1.0f : -1.0f;
    return {corner(0) - axis * extent, axis, kInfinity};
  }
  const Vec3 to_target = target == origin ? Vec3(0, 0, 1) : target - origin;
  const float t_max = random.bits() % 4 == 0 ? glm::length(to_target) * random.uniform(0.5f, 1.5f) : kInfinity;
  return {origin, glm::normalize(to_target), t_max};
}

/// Triangles of a size, around random points.
inline std::vector<Vec3> random_triangles(Random& random, int count, float extent, float size) {
  std::vector<Vec3> corners;
  for (int i = 0; i < count; ++i) {
    const Vec3 center = random.point(-extent, extent);
    for (int k = 0; k < 3; ++k) corners.push_back(center + random.point(-size, size));
  }
  return corners;
}

}  // namespace relume::testing
