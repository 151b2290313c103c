// Place of a surface point without its shading.
#pragma once

#include "scene/surface_point.h"

namespace relume {

struct SurfacePlace {
  Vec3 position;  ///< metres, world space
  Vec3 front;     ///< geometric normal of the front, unit; zero on degenerate triangles
  float error;    ///< bound on the rounding error of the position per component, metres
};

/// Place of a hit's point on `instance`, that of the hit or one with another placement.
RELUME_HD inline SurfacePlace surface_place(const SceneView& scene, const Instance& instance, const Hit& hit) {
  using namespace surface_detail;
  const MeshView& mesh = scene.meshes[instance.mesh];
  const Geometry g = geometry_at(scene, mesh, instance, triangle_at(scene, mesh, hit.primitive, hit.u, hit.v));
  const float length = glm::length(g.front);
  return {g.position, length > 0.0f ? g.front / length : Vec3(0), g.error};
}

}  // namespace relume
