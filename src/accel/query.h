// Rules of ray queries that hold for every acceleration structure.
#pragma once

#include "core/hash.h"
#include "core/ray.h"

namespace relume {

/// Flags of rays that leave the camera or end there.
inline constexpr unsigned kFromCamera = 1;
inline constexpr unsigned kToCamera = 2;

/// Whether a ray is finite. Others hit nothing; Embree would terminate the process.
RELUME_HD inline bool is_traceable(const Ray& ray) {
  constexpr float kMost = 1e17f;
  const Vec3 reach = abs(ray.origin) + abs(ray.direction);
  return reach.x + reach.y + reach.z <= kMost && ray.t_max >= 0.0f;
}

/// Whether a triangle of that opacity stops the ray. The decision is a hash, so it does not depend on the order of
/// candidates, and repeated calls for one primitive agree.
RELUME_HD inline bool stops(float opacity, uint32_t ray_id, uint32_t instance, uint32_t primitive) {
  return opacity >= 1.0f || (opacity > 0.0f && to_unit_float(hash(ray_id, instance, primitive)) < opacity);
}

}  // namespace relume
