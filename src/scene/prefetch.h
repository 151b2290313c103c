// Prefetching of surface data, on the host.
#pragma once

#include "scene/scene_view.h"

namespace relume {

/// Loads the memory that make_surface_point() reads for hits[places[0 … count − 1]] into the caches. Evaluated one
/// after another, the hits would wait for it. Each loop requests what the next one reads.
inline void prefetch_surfaces(const SceneView& scene, const Hit* hits, const uint32_t* places, uint32_t count) {
  const auto for_each_hit = [&](const auto& request) {
    for (uint32_t k = 0; k < count; ++k) {
      const Hit& hit = hits[places[k]];
      if (hit.valid()) request(hit, scene.instances[hit.instance]);
    }
  };
  const auto triangle_of = [&](const Hit& hit, const Instance& instance) -> const UVec3& {
    return scene.triangles[scene.meshes[instance.mesh].first_triangle + hit.primitive];
  };
  for_each_hit([](const Hit&, const Instance& instance) { __builtin_prefetch(&instance.mesh); });
  for_each_hit([&](const Hit& hit, const Instance& instance) {
    if (!instance.in_world_space) __builtin_prefetch(&instance.to_world);
    __builtin_prefetch(&triangle_of(hit, instance));
  });
  for_each_hit([&](const Hit& hit, const Instance& instance) {
    const UVec3& corners = triangle_of(hit, instance);
    for (int c = 0; c < 3; ++c) __builtin_prefetch(&scene.vertices[corners[c]]);
  });
}

}  // namespace relume
