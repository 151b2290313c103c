// All triangles of a scene as they stand in the world.
#pragma once

#include "core/box.h"
#include "scene/scene_view.h"

namespace relume {

/// Calls f(corner, corner, corner) for every triangle of every instance that is visible.
template <typename F>
void for_each_world_triangle(const SceneView& scene, const F& f) {
  for (const Instance& instance : scene.instances) {
    if (!instance.visible) continue;
    const MeshView& mesh = scene.meshes[instance.mesh];
    for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
      const UVec3 index = scene.triangles[mesh.first_triangle + t];
      Vec3 v[3];
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = scene.vertices[index[k]].position;
        v[k] = instance.in_world_space ? p : instance.to_world.point(p);
      }
      f(v[0], v[1], v[2]);
    }
  }
}

/// The box about all surfaces as they stand now; empty without any.
inline Box world_box(const SceneView& scene) {
  Box box;
  for_each_world_triangle(scene, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    box.add(a);
    box.add(b);
    box.add(c);
  });
  return box;
}

}  // namespace relume
