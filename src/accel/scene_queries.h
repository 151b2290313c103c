// Ray queries for kernels. On the host, the functions of accel.h answer them. Device code traverses the BVH, and
// evaluates the opacity of surfaces itself.
//
// `Scene` has a member `accel`, its AccelView, and a function opacity(scene, instance, primitive, u, v), which returns
// the opacity of a point, in [0, 1]. The function of a host structure (OpacityFunction) must return the same bits.
#pragma once

#include "accel/accel.h"
#include "accel/bvh/postponed_nodes.h"
#include "accel/bvh/traverse.h"

namespace relume {

// These three are called in device code only, and by tests. They are not inlined: all kernels share one copy, and the
// rare opacity takes no registers from the traversal.

template <typename Scene>
RELUME_HD_NOINLINE float opacity_in(const Scene& scene, uint32_t instance, uint32_t primitive, float u, float v) {
  return opacity(scene, instance, primitive, u, v);
}

/// Calls opacity_in().
template <typename Scene>
struct OpacityIn {
  const Scene& scene;

  RELUME_HD_INLINE float operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
    return opacity_in(scene, instance, primitive, u, v);
  }
};

/// As intersect() and intersect_from_camera(). `camera`: kFromCamera or 0.
template <typename Scene>
RELUME_HD_NOINLINE Hit traverse_to_nearest(const Scene& scene, const Ray& ray, uint32_t ray_id, unsigned camera) {
  return bvh_intersect<PostponedNodes>(scene.accel.bvh, ray, ray_id, camera, OpacityIn<Scene>{scene});
}

/// As occluded() and occluded_to_camera(). `camera`: kToCamera or 0.
template <typename Scene>
RELUME_HD_NOINLINE bool traverse_to_any(const Scene& scene, const Ray& ray, uint32_t ray_id, unsigned camera) {
  return bvh_occluded<PostponedNodes>(scene.accel.bvh, ray, ray_id, camera, OpacityIn<Scene>{scene});
}

/// Nearest hit along the ray, as intersect() or, with kFromCamera as `kFlag`, intersect_from_camera().
template <unsigned kFlag, typename Scene>
RELUME_HD_INLINE Hit nearest_in_scene(const Scene& scene, const Ray& ray, uint32_t ray_id) {
#if RELUME_DEVICE_CODE
  const Ray copy = ray;  // a reference would keep the object around the ray in memory
  return traverse_to_nearest(scene, copy, ray_id, kFlag);
#else
  return kFlag != 0 ? intersect_from_camera(scene.accel, ray, ray_id) : intersect(scene.accel, ray, ray_id);
#endif
}

/// Whether anything blocks the ray, as occluded() or, with kToCamera as `kFlag`, occluded_to_camera().
template <unsigned kFlag, typename Scene>
RELUME_HD_INLINE bool blocked_in_scene(const Scene& scene, const Ray& ray, uint32_t ray_id) {
#if RELUME_DEVICE_CODE
  const Ray copy = ray;
  return traverse_to_any(scene, copy, ray_id, kFlag);
#else
  return kFlag != 0 ? occluded_to_camera(scene.accel, ray, ray_id) : occluded(scene.accel, ray, ray_id);
#endif
}

}  // namespace relume
