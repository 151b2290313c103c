// Filters the hits of the traversal by culling and opacity.
#pragma once

#include "accel/embree/embree.h"
#include "accel/embree_accel.h"
#include "accel/query.h"

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

/// Query filter that culls back faces. Only rays with kFromCamera or kToCamera in RTCRay::flags incur its cost.
void culling_filter(const RTCFilterFunctionNArguments* args);

/// Registers opacity_filter() for hits on a geometry whose mesh needs it, and enables culling_filter() of queries. The
/// geometry must be committed afterwards.
void set_filter(RTCGeometry geometry, GeometryContext* context);

}  // namespace relume
