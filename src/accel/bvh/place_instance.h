// Prepares instances for the traversal.
#pragma once

#include <cmath>
#include <optional>
#include <span>

#include "accel/accel_structure.h"
#include "accel/bvh/box_ray.h"
#include "core/box.h"

namespace relume {

/// Prepares an instance of a mesh whose tree has these `bounds`. std::nullopt if its inverse exceeds kMostInverse.
inline std::optional<BvhInstance> place_instance(const AccelInstance& source, uint32_t index, BvhChild root,
                                                 const Box& bounds) {
  const Mat4 to_world = source.in_world_space ? Mat4(1) : source.to_world;
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(glm::dmat4(to_world)));
  BvhInstance result;
  result.instance = index;
  result.root = root;
  const float largest = max_component(glm::max(abs(bounds.low), abs(bounds.high)));
  Vec3 reach = abs(Vec3(to_world[3]));
  result.margin = Vec3(0);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (!(std::fabs(inverse[i][k]) <= kMostInverse)) return std::nullopt;
    }
    result.to_world[i] = Vec3(to_world[i]);
    result.to_mesh[i] = Vec3(inverse[i]);
    result.margin += kInstanceMargin * abs(result.to_mesh[i]);
    reach += largest * abs(result.to_world[i]);
  }
  result.to_world[3] = Vec3(to_world[3]);
  result.reach = max_component(reach);
  return result;
}

/// Columns of an affine matrix.
inline BvhKey bvh_key(const Mat4& m) { return {{Vec3(m[0]), Vec3(m[1]), Vec3(m[2]), Vec3(m[3])}}; }

/// BvhInstance::reach of a mesh with these `bounds` at one key.
inline float reach_at(const BvhKey& key, const Box& bounds) {
  const float largest = max_component(glm::max(abs(bounds.low), abs(bounds.high)));
  Vec3 reach = abs(key.to_world[3]);
  for (int i = 0; i < 3; ++i) reach += largest * abs(key.to_world[i]);
  return max_component(reach);
}

/// Whether the transform turns front faces into back faces.
inline bool mirrors(const AccelInstance& source) {
  return !source.in_world_space && glm::determinant(glm::dmat3(glm::dmat4(source.to_world))) < 0.0;
}

/// World-space bounds of an instance at all times of an open shutter. Between two keys, the points of the mesh move
/// along straight lines. The margin of each key is doubled, because the interpolated matrix is rounded.
inline Box swept_box(std::span<const BvhKey> keys, float reach, const Box& bounds) {
  Box box;
  for (const BvhKey& key : keys) {
    Mat4 to_world(1);
    for (int i = 0; i < 4; ++i) to_world[i] = Vec4(key.to_world[i], i == 3 ? 1.0f : 0.0f);
    box.add(transformed(bounds, to_world));
  }
  const float margin = 2.0f * kInstanceMargin * reach;
  return {box.low - margin, box.high + margin};
}

/// World-space bounds of an instance, with the margin that BoxRay needs.
inline Box placed_box(const BvhInstance& instance, const Box& bounds) {
  Mat4 to_world(1);
  for (int i = 0; i < 4; ++i) to_world[i] = Vec4(instance.to_world[i], i == 3 ? 1.0f : 0.0f);
  const Box box = transformed(bounds, to_world);
  const float margin = kInstanceMargin * instance.reach;
  return {box.low - margin, box.high + margin};
}

}  // namespace relume
