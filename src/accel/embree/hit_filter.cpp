#include "accel/embree/hit_filter.h"

#include "accel/triangle.h"

namespace relume {
namespace {

/// Ray origin in mesh space, the space of filter callbacks.
Vec3 origin_of(const RTCFilterFunctionNArguments& args, unsigned i) {
  return {RTCRayN_org_x(args.ray, args.N, i), RTCRayN_org_y(args.ray, args.N, i), RTCRayN_org_z(args.ray, args.N, i)};
}

Vec3 direction_of(const RTCFilterFunctionNArguments& args, unsigned i) {
  return {RTCRayN_dir_x(args.ray, args.N, i), RTCRayN_dir_y(args.ray, args.N, i), RTCRayN_dir_z(args.ray, args.N, i)};
}

/// Corners of the triangle of a hit at the time of its ray, in mesh space.
TriangleCorners corners_of_hit(const RTCFilterFunctionNArguments& args, const AccelMesh& mesh, unsigned i) {
  return corners_at(mesh, RTCHitN_primID(args.hit, args.N, i), RTCRayN_time(args.ray, args.N, i));
}

/// Whether a triangle turns its back to the camera at one end of the ray. A mirroring instance mirrors both.
bool is_behind(unsigned flags, const Vec3& direction, const TriangleCorners& c, bool mirrored) {
  const float front = mirrored ? -1.0f : 1.0f;
  const float along = front * glm::dot(glm::cross(c.p1 - c.p0, c.p2 - c.p0), direction);
  return flags == kFromCamera ? along > 0.0f : flags == kToCamera && along < 0.0f;
}

/// Accepts or rejects a hit by the surface's opacity.
void opacity_filter(const RTCFilterFunctionNArguments* args) {
  const auto& geometry = *static_cast<const GeometryContext*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const uint32_t primitive = RTCHitN_primID(args->hit, args->N, i);
    const TriangleCorners c = corners_of_hit(*args, *geometry.mesh, i);
    const uint32_t instance = instance_of(geometry.id, RTCHitN_instID(args->hit, args->N, i, 0));
    const TriangleHit hit = intersect_triangle(origin_of(*args, i), direction_of(*args, i), c.p0, c.p1, c.p2);
    const float opacity = geometry.opacity->function(geometry.opacity->context, instance, primitive, hit.u, hit.v);
    const uint32_t ray_id = RTCRayN_id(args->ray, args->N, i);
    if (!stops(opacity, ray_id, instance, primitive)) args->valid[i] = 0;
  }
}

}  // namespace

void culling_filter(const RTCFilterFunctionNArguments* args) {
  const AccelMesh& mesh = *static_cast<const GeometryContext*>(args->geometryUserPtr)->mesh;
  if (!mesh.culls_back_faces) return;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const TriangleCorners c = corners_of_hit(*args, mesh, i);
    if (is_behind(RTCRayN_flags(args->ray, args->N, i), direction_of(*args, i), c, mesh.mirrored)) args->valid[i] = 0;
  }
}

void set_filter(RTCGeometry geometry, GeometryContext* context) {
  rtcSetGeometryUserData(geometry, context);
  rtcSetGeometryIntersectFilterFunction(geometry, context->mesh->needs_opacity ? opacity_filter : nullptr);
  rtcSetGeometryOccludedFilterFunction(geometry, context->mesh->needs_opacity ? opacity_filter : nullptr);
  embree::enable_query_filter(geometry, context->mesh->culls_back_faces);
}

}  // namespace relume
