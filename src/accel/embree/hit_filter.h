// Filters the hits of the traversal by culling and opacity.
#pragma once

#include "accel/embree/embree.h"
#include "accel/embree_accel.h"

namespace relume {

/// Node of all static geometry, if it has a separate scene.
inline constexpr uint32_t kStillNode = 0;

/// Number of instance i, as a node or, in world space, as a geometry: one scene may contain both.
inline uint32_t id_of(uint32_t instance) { return instance + 1; }

/// Instance of a hit.
inline uint32_t instance_of(uint32_t geometry, uint32_t node) {
  return (node == RTC_INVALID_GEOMETRY_ID || node == kStillNode ? geometry : node) - id_of(0);
}

/// Data of a geometry for filter callbacks.
struct GeometryContext {
  const OpacityFunction* opacity = nullptr;
  const AccelMesh* mesh = nullptr;
  uint32_t id = 0;  ///< used for geometries that are not below an instance node
};

struct Corners {
  Vec3 p0, p1, p2;
};

/// Corners of a triangle in the space of its mesh.
inline Corners corners_of(const AccelMesh& mesh, uint32_t primitive) {
  const uint32_t* index = mesh.indices + size_t{3} * primitive;
  return {vertex_position(mesh, index[0]), vertex_position(mesh, index[1]), vertex_position(mesh, index[2])};
}

/// RTCRay::flags of rays that leave the camera or end there.
inline constexpr unsigned kFromCamera = 1;
inline constexpr unsigned kToCamera = 2;

/// Query filter that culls back faces. Only rays with one of these flags incur its cost.
void culling_filter(const RTCFilterFunctionNArguments* args);

/// Registers opacity_filter() for hits on a geometry whose mesh needs it, and enables culling_filter() of queries. The
/// geometry must be committed afterwards.
void set_filter(RTCGeometry geometry, GeometryContext* context);

}  // namespace relume
