// Ray queries on the host, which Embree or relume's own BVH answers. Kernels call scene/ray_queries.h for single rays;
// their host forms call the packet functions below.
#pragma once

#include <cstdint>

#include "accel/accel_choice.h"
#include "accel/bvh/layout.h"
#include "core/ray.h"

namespace relume {

struct HostAccelData;

/// Handle to data outside of kernel memory (accel/host_accel.h). The only pointer in a kernel that is not part of a
/// View. Device code never reads it.
struct HostAccel {
  const HostAccelData* data = nullptr;
};

/// The acceleration structure of a compiled scene. A default view is empty: rays hit nothing.
struct AccelView {
  BvhView bvh;     ///< empty with Embree
  HostAccel host;  ///< Embree's scene, and the opacity of surfaces
  AccelChoice choice = AccelChoice::bvh;
};

/// Nearest hit along the ray; no hit if the ray is not finite. `ray_id` seeds stochastic alpha: equal (ray id,
/// instance, primitive) give equal decisions. Barycentrics and distance are from intersect_triangle().
Hit intersect(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// Whether anything blocks the ray before ray.t_max.
bool occluded(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// The same for rays that leave the camera, or end there. Camera rays pass through faces seen from the back if their
/// mesh culls back faces; all other rays hit both sides.
Hit intersect_from_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id);
bool occluded_to_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id);

/// Capacity of a host packet, rays.
inline constexpr int kPacketSize = 16;

/// intersect() for up to kPacketSize rays at once, with the same results. While a shutter is open, Embree may round the
/// transforms of a packet in another way than those of a single ray, so that hits at edges may differ.
void intersect_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits, int count);

/// intersect_from_camera() for up to kPacketSize rays of neighbouring pixels at once, with the same results.
void intersect_packet_from_camera(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits,
                                  int count);

/// Occlusion of up to kPacketSize rays at once.
void occluded_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, bool* occluded, int count);

}  // namespace relume
