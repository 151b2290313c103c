// Intersection of a ray with a triangle that the traversal reports as hit. The traversal only selects the triangle. Its
// rounding depends on its version, but only affects shared edges and coincident faces, where two triangles compete.
#pragma once

#include "core/vec.h"

namespace relume {

struct TriangleCorners {
  Vec3 p0, p1, p2;
};

/// Barycentric weights of the second and third corner, and the distance in lengths of the ray's direction.
struct TriangleHit {
  float u = 0;
  float v = 0;
  float t = 0;
};

/// Intersection of the ray's line with the triangle's plane ([Moeller97]), clamped to the triangle and to t >= 0. If
/// the plane contains the ray, or a product overflows, the hit is the triangle's centroid.
RELUME_HD inline TriangleHit intersect_triangle(const Vec3& origin, const Vec3& direction, const Vec3& p0,
                                                const Vec3& p1, const Vec3& p2) {
  const Vec3 e1 = p1 - p0;
  const Vec3 e2 = p2 - p0;
  const Vec3 s = origin - p0;
  const Vec3 q = glm::cross(direction, e2);
  const Vec3 r = glm::cross(s, e1);
  const float scale = 1.0f / glm::dot(e1, q);
  const float u = glm::dot(s, q) * scale;
  const float v = glm::dot(direction, r) * scale;
  const float t = glm::dot(e2, r) * scale;
  if (!is_finite(u + v + t)) {
    constexpr float kThird = 1.0f / 3.0f;
    const Vec3 to_centroid = (e1 + e2) * kThird - s;
    return {kThird, kThird, relume::max(0.0f, glm::dot(to_centroid, direction))};
  }
  const float inside_u = clamp(u, 0.0f, 1.0f);
  return {inside_u, clamp(v, 0.0f, 1.0f - inside_u), relume::max(t, 0.0f)};
}

}  // namespace relume
