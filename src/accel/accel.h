// Ray queries, the interface of kernels to the acceleration structure. Embree or relume's own BVH answers them.
#pragma once

#include <cstdint>

#include "core/ray.h"

namespace relume {

struct AccelMesh;
struct AccelInstance;
struct BvhView;

/// Handle to the acceleration structure of a compiled scene: relume's own BVH, or Embree's scene, which needs the
/// meshes and instances beside it.
struct AccelView {
  void* scene = nullptr;
  const AccelMesh* meshes = nullptr;
  const AccelInstance* instances = nullptr;
  const BvhView* bvh = nullptr;  ///< null: Embree answers
};

/// Nearest hit along the ray; no hit if the ray is not finite. `ray_id` seeds stochastic alpha: equal (ray id,
/// instance, primitive) give equal decisions. Barycentrics and distance are from intersect_triangle().
RELUME_HD Hit intersect(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// Whether anything blocks the ray before ray.t_max.
RELUME_HD bool occluded(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// The same for rays that leave the camera, or end there. Camera rays pass through faces seen from the back if their
/// mesh culls back faces; all other rays hit both sides.
RELUME_HD Hit intersect_from_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id);
RELUME_HD bool occluded_to_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// Capacity of a host packet, rays.
inline constexpr int kPacketSize = 16;

/// Host only: intersect() for up to kPacketSize rays at once, with the same results.
void intersect_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits, int count);

/// Host only: intersect_from_camera() for up to kPacketSize rays of neighbouring pixels at once, with the same results.
void intersect_packet_from_camera(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits,
                                  int count);

/// Host only: occlusion of up to kPacketSize rays at once.
void occluded_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, bool* occluded, int count);

}  // namespace relume
