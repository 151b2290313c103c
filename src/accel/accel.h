// Ray queries. On the host Embree answers them; kernels see only these functions.
#pragma once

#include <cstdint>

#include "core/ray.h"

namespace relume {

struct AccelMesh;
struct AccelInstance;

/// Handle to the acceleration structure of a compiled scene.
struct AccelView {
  void* scene = nullptr;
  const AccelMesh* meshes = nullptr;
  const AccelInstance* instances = nullptr;
};

/// Nearest hit along the ray; none if the ray is not finite. `ray_id` decides stochastic alpha: the same (ray id,
/// instance, primitive) decides the same. Barycentrics and distance come from intersect_triangle().
RELUME_HD Hit intersect(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// Whether anything lies on the ray before ray.t_max.
RELUME_HD bool occluded(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// The same for a ray that leaves the camera, and for one that ends there. Between the camera and what it sees, faces
/// whose back is turned to it are not there if their mesh culls back faces; all other rays meet both sides.
RELUME_HD Hit intersect_from_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id);
RELUME_HD bool occluded_to_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// Rays a host packet holds.
inline constexpr int kPacketSize = 8;

/// Host only: nearest hits of up to kPacketSize camera rays at once.
void intersect_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits, int count,
                      bool coherent);

/// Host only: occlusion of up to kPacketSize rays at once.
void occluded_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, bool* occluded, int count);

}  // namespace relume
