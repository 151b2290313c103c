// Ray queries of kernels, on the host and on devices. The functions of accel.h with the same names are for the host
// only.
#pragma once

#include "accel/scene_queries.h"
#include "scene/surface_point.h"

namespace relume {

/// Nearest hit along the ray; no hit if the ray is not finite. `ray_id` seeds stochastic alpha: equal (ray id,
/// instance, primitive) give equal decisions. A device finds the hits of AccelChoice::bvh, bit for bit.
RELUME_HD_INLINE Hit intersect(const SceneView& scene, const Ray& ray, uint32_t ray_id) {
  return nearest_in_scene<0>(scene, ray, ray_id);
}

/// Whether anything blocks the ray before ray.t_max.
RELUME_HD_INLINE bool occluded(const SceneView& scene, const Ray& ray, uint32_t ray_id) {
  return blocked_in_scene<0>(scene, ray, ray_id);
}

/// The same for rays that leave the camera, or end there, which pass through culled back faces.
RELUME_HD_INLINE Hit intersect_from_camera(const SceneView& scene, const Ray& ray, uint32_t ray_id) {
  return nearest_in_scene<kFromCamera>(scene, ray, ray_id);
}
RELUME_HD_INLINE bool occluded_to_camera(const SceneView& scene, const Ray& ray, uint32_t ray_id) {
  return blocked_in_scene<kToCamera>(scene, ray, ray_id);
}

}  // namespace relume
