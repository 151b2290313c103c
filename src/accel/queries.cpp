// Answers ray queries on the host. Embree's part is here, inlined; that of relume's own BVH is in accel/bvh.
#include <cmath>

#include "accel/bvh/queries.h"
#include "accel/embree/hit_filter.h"
#include "accel/host_accel.h"
#include "accel/query.h"
#include "accel/triangle.h"
#include "core/fixed_point.h"

namespace relume {
namespace {

/// Computes the hit on the triangle that the traversal found.
Hit hit_on(const HostAccelData& accel, const Ray& ray, uint32_t instance_index, uint32_t primitive) {
  const AccelInstance& instance = accel.instances[instance_index];
  TriangleCorners c = corners_at(accel.meshes[instance.mesh], primitive, ray.time);
  if (!instance.in_world_space) {
    const Mat4& to_world = instance.key_count == 0 ? instance.to_world : to_world_at(instance, ray.time);
    c = {transform_point(to_world, c.p0), transform_point(to_world, c.p1), transform_point(to_world, c.p2)};
  }
  const TriangleHit hit = intersect_triangle(ray.origin, ray.direction, c.p0, c.p1, c.p2);
  return {instance_index, primitive, hit.u, hit.v, hit.t};
}

/// A triangle that the traversal of a packet found for a ray.
struct Found {
  int ray;
  uint32_t instance;
  uint32_t primitive;
};

/// hit_on() for the triangles of a packet. Each loop prefetches what the next one reads: otherwise every ray would wait
/// for its own memory.
void find_hits(const HostAccelData& accel, const Ray* rays, const Found* found, int count, Hit* hits) {
  const auto mesh_of = [&](const Found& f) -> const AccelMesh& {
    return accel.meshes[accel.instances[f.instance].mesh];
  };
  for (int k = 0; k < count; ++k) prefetch(&accel.instances[found[k].instance]);
  for (int k = 0; k < count; ++k) prefetch(mesh_of(found[k]).indices + 3 * size_t{found[k].primitive});
  for (int k = 0; k < count; ++k) {
    const AccelMesh& mesh = mesh_of(found[k]);
    const uint32_t* corners = mesh.indices + 3 * size_t{found[k].primitive};
    for (int c = 0; c < 3; ++c)
      prefetch(reinterpret_cast<const std::byte*>(mesh.positions) + corners[c] * mesh.position_stride);
  }
  for (int k = 0; k < count; ++k) {
    const Found& f = found[k];
    hits[f.ray] = hit_on(accel, rays[f.ray], f.instance, f.primitive);
  }
}

RTCScene as_scene(const HostAccelData& accel) { return static_cast<RTCScene>(accel.embree_scene); }

RTCRay to_embree(const Ray& ray, uint32_t ray_id, unsigned flags) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.tnear = 0.0f;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.time = ray.time;
  r.tfar = ray.t_max;
  r.mask = 0xffffffffu;
  r.id = ray_id;
  r.flags = flags;
  return r;
}

/// Filter for rays with these flags.
RTCFilterFunctionN filter_of(RTCScene scene, unsigned flags) {
  return flags != 0 && embree::takes_query_filter(scene) ? culling_filter : nullptr;
}

Hit nearest_in_embree(const HostAccelData& accel, const Ray& ray, uint32_t ray_id, unsigned flags) {
  if (!is_traceable(ray)) return {};
  RTCRayHit query;
  query.ray = to_embree(ray, ray_id, flags);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::intersect1(as_scene(accel), query, filter_of(as_scene(accel), flags));
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return hit_on(accel, ray, instance_of(query.hit.geomID, query.hit.instID[0]), query.hit.primID);
}

bool blocked_in_embree(const HostAccelData& accel, const Ray& ray, uint32_t ray_id, unsigned flags) {
  if (!is_traceable(ray)) return false;
  RTCRay query = to_embree(ray, ray_id, flags);
  embree::occluded1(as_scene(accel), query, filter_of(as_scene(accel), flags));
  return query.tfar < 0.0f;
}

Hit nearest(const AccelView& accel, const Ray& ray, uint32_t ray_id, unsigned flags) {
  return accel.choice == AccelChoice::bvh ? nearest_in_bvh(accel, ray, ray_id, flags)
                                          : nearest_in_embree(*accel.host.data, ray, ray_id, flags);
}

bool blocked(const AccelView& accel, const Ray& ray, uint32_t ray_id, unsigned flags) {
  return accel.choice == AccelChoice::bvh ? blocked_in_bvh(accel, ray, ray_id, flags)
                                          : blocked_in_embree(*accel.host.data, ray, ray_id, flags);
}

/// A ray that ends before it begins. Without AVX-512, Embree 3 checks the numbers of all lanes of a packet, also of
/// those that are not valid.
const Ray kInactive{Vec3(0), Vec3(0, 0, 1), -1.0f};

template <typename Packet>
void fill_packet(Packet& packet, int i, const Ray& ray, uint32_t ray_id, unsigned flags) {
  packet.org_x[i] = ray.origin.x;
  packet.org_y[i] = ray.origin.y;
  packet.org_z[i] = ray.origin.z;
  packet.tnear[i] = 0.0f;
  packet.dir_x[i] = ray.direction.x;
  packet.dir_y[i] = ray.direction.y;
  packet.dir_z[i] = ray.direction.z;
  packet.time[i] = ray.time;
  packet.tfar[i] = ray.t_max;
  packet.mask[i] = 0xffffffffu;
  packet.id[i] = ray_id;
  packet.flags[i] = flags;
}

void intersect_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits, int count,
                      unsigned flags) {
  if (accel.choice == AccelChoice::bvh) {
    for (int i = 0; i < count; ++i) hits[i] = nearest_in_bvh(accel, rays[i], ray_ids[i], flags);
    return;
  }
  const HostAccelData& host = *accel.host.data;
  RTCRayHit16 query;
  alignas(64) int valid[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    const bool active = i < count && is_traceable(rays[i]);
    valid[i] = active ? -1 : 0;
    fill_packet(query.ray, i, active ? rays[i] : kInactive, active ? ray_ids[i] : 0, flags);
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  embree::intersect16(valid, as_scene(host), query, filter_of(as_scene(host), flags));
  Found found[kPacketSize];
  int found_count = 0;
  for (int i = 0; i < count; ++i) {
    hits[i] = {};
    if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    found[found_count++] = {i, instance_of(query.hit.geomID[i], query.hit.instID[0][i]), query.hit.primID[i]};
  }
  find_hits(host, rays, found, found_count, hits);
}

}  // namespace

Hit intersect(const AccelView& accel, const Ray& ray, uint32_t ray_id) { return nearest(accel, ray, ray_id, 0); }

Hit intersect_from_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id) {
  return nearest(accel, ray, ray_id, kFromCamera);
}

bool occluded(const AccelView& accel, const Ray& ray, uint32_t ray_id) { return blocked(accel, ray, ray_id, 0); }

bool occluded_to_camera(const AccelView& accel, const Ray& ray, uint32_t ray_id) {
  return blocked(accel, ray, ray_id, kToCamera);
}

void intersect_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits, int count) {
  intersect_packet(accel, rays, ray_ids, hits, count, 0);
}

void intersect_packet_from_camera(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, Hit* hits,
                                  int count) {
  intersect_packet(accel, rays, ray_ids, hits, count, kFromCamera);
}

void occluded_packet(const AccelView& accel, const Ray* rays, const uint32_t* ray_ids, bool* result, int count) {
  if (accel.choice == AccelChoice::bvh) {
    for (int i = 0; i < count; ++i) result[i] = blocked_in_bvh(accel, rays[i], ray_ids[i], 0);
    return;
  }
  RTCRay16 query;
  alignas(64) int valid[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    const bool active = i < count && is_traceable(rays[i]);
    valid[i] = active ? -1 : 0;
    fill_packet(query, i, active ? rays[i] : kInactive, active ? ray_ids[i] : 0, 0);
  }
  embree::occluded16(valid, as_scene(*accel.host.data), query, nullptr);
  for (int i = 0; i < count; ++i) result[i] = valid[i] != 0 && query.tfar[i] < 0.0f;
}

}  // namespace relume
