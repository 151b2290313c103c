// Ray queries that relume's own BVH answers on the host.
#pragma once

#include "accel/accel.h"

namespace relume {

/// As intersect() and occluded(). `camera`: kFromCamera, kToCamera or 0.
Hit nearest_in_bvh(const AccelView& accel, const Ray& ray, uint32_t ray_id, unsigned camera);
bool blocked_in_bvh(const AccelView& accel, const Ray& ray, uint32_t ray_id, unsigned camera);

}  // namespace relume
