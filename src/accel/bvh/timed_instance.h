// Instances of the BVH that move or deform while the shutter is open: their matrices and corners at the time of a ray.
#pragma once

#include "accel/bvh/box_ray.h"
#include "accel/bvh/layout.h"
#include "accel/triangle.h"

namespace relume {

/// The inverse of a matrix's linear part, and the margins of BoxRay for it. Double precision inside, so that margins
/// need no bound on the condition of the matrix.
struct MeshSpace {
  Vec3 to_mesh[3];  ///< columns
  Vec3 margin{0};   ///< as BvhInstance::margin

  RELUME_HD explicit MeshSpace(const Vec3 (&to_world)[4]) {
    const glm::dmat3 linear{glm::dvec3(to_world[0]), glm::dvec3(to_world[1]), glm::dvec3(to_world[2])};
    const glm::dmat3 inverse = glm::inverse(linear);
    for (int i = 0; i < 3; ++i) {
      to_mesh[i] = Vec3(inverse[i]);
      margin += kInstanceMargin * abs(to_mesh[i]);
    }
  }
};

/// Columns of the matrix of an instance at a time within the shutter.
RELUME_HD_INLINE void matrix_at(const BvhView& bvh, const BvhInstance& instance, float time, Vec3 (&columns)[4]) {
  if (instance.first_key == kNoKeys) {
    for (int i = 0; i < 4; ++i) columns[i] = instance.to_world[i];
    return;
  }
  const KeyTime at(time, bvh.key_count);
  const BvhKey& a = bvh.keys[instance.first_key + at.first];
  const BvhKey& b = bvh.keys[instance.first_key + at.first + 1];
  for (int i = 0; i < 4; ++i) columns[i] = at.mix(a.to_world[i], b.to_world[i]);
}

/// Corners of a triangle of the BVH at a time within the shutter, in world space. They have the bits of
/// transform_point() for to_world_at() and corners_at() (accel_structure.h).
RELUME_HD_INLINE TriangleCorners corners_at(const BvhView& bvh, uint32_t triangle, const BvhInstance& instance,
                                            float time) {
  Vec3 m[4];
  matrix_at(bvh, instance, time, m);
  const BvhTriangle& rest = bvh.triangles[triangle];
  TriangleCorners c{rest.p0, rest.p1, rest.p2};
  if (instance.first_corner != kNoKeys) {
    const KeyTime at(time, bvh.key_count);
    const uint32_t key = (triangle - instance.first_triangle) * bvh.key_count + at.first;
    const Vec3* a = bvh.corner_keys.data + (instance.first_corner + 3 * key);
    c = {at.mix(a[0], a[3]), at.mix(a[1], a[4]), at.mix(a[2], a[5])};
  }
  const auto place = [&](const Vec3& p) { return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3]; };
  return {place(c.p0), place(c.p1), place(c.p2)};
}

}  // namespace relume
