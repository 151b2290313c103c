// All triangles of a scene in world space.
#pragma once

#include "core/box.h"
#include "scene/scene_view.h"

namespace relume {

/// Calls f(corner, corner, corner) for every triangle of the instance, unless it is hidden.
template <typename F>
void for_each_world_triangle(const SceneView& scene, const Instance& instance, const F& f) {
  if (!instance.visible) return;
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

/// The same for every triangle of every instance.
template <typename F>
void for_each_world_triangle(const SceneView& scene, const F& f) {
  for (const Instance& instance : scene.instances) for_each_world_triangle(scene, instance, f);
}

/// Bounds of all surfaces at the current time; empty without any. Exact, although most of many instances are tested by
/// the corners of their boxes only.
Box world_box(const SceneView& scene);

}  // namespace relume
