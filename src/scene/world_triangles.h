// All triangles of a scene as they stand in the world.
#pragma once

#include "core/box.h"
#include "scene/scene_view.h"

namespace relume {

/// Calls f(corner, corner, corner) for every triangle of the instance; of none that is hidden.
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

/// The box about all surfaces as they stand now; empty without any. Exact, but most instances of many are looked at by
/// the corners of their boxes alone.
Box world_box(const SceneView& scene);

}  // namespace relume
