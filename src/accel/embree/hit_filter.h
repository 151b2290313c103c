// Decides which hits of the traversal count, by culling and by opacity.
#pragma once

#include "accel/embree/embree.h"
#include "accel/embree_accel.h"

namespace relume {

/// The node that holds all that stands still, where that has a scene of its own.
inline constexpr uint32_t kStillNode = 0;

/// Instance i has this number, as a node or, in world space, as a geometry: both kinds may lie in one scene.
inline uint32_t id_of(uint32_t instance) { return instance + 1; }

/// The instance that was hit.
inline uint32_t instance_of(uint32_t geometry, uint32_t node) {
  return (node == RTC_INVALID_GEOMETRY_ID || node == kStillNode ? geometry : node) - id_of(0);
}

/// What a filter callback knows about its geometry.
struct GeometryContext {
  const OpacityFunction* opacity = nullptr;
  const AccelMesh* mesh = nullptr;
  uint32_t id = 0;  ///< used where the geometry is not below an instance node
};

struct Corners {
  Vec3 p0, p1, p2;
};

/// Corners of a triangle in the space of its mesh.
inline Corners corners_of(const AccelMesh& mesh, uint32_t primitive) {
  const uint32_t* index = mesh.indices + size_t{3} * primitive;
  return {vertex_position(mesh, index[0]), vertex_position(mesh, index[1]), vertex_position(mesh, index[2])};
}

/// In RTCRay::flags, of rays that leave the camera or end there.
inline constexpr unsigned kFromCamera = 1;
inline constexpr unsigned kToCamera = 2;

/// Filter of queries whose rays have one of these flags: culls back faces. Only they pay for it.
void culling_filter(const RTCFilterFunctionNArguments* args);

/// Has Embree ask opacity_filter() about the hits on a geometry whose mesh needs it, and queries with culling_filter()
/// about culling. The geometry must be committed afterwards.
void set_filter(RTCGeometry geometry, GeometryContext* context);

}  // namespace relume
