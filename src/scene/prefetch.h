// Prefetching of surface data, on the host.
#pragma once

#include "core/fixed_point.h"
#include "scene/scene_view.h"

namespace relume {

/// Prefetches instance, triangle and vertices of the hits at `places`, before make_surface_point() evaluates one after
/// another. Each loop prefetches what the next one reads.
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
  for_each_hit([](const Hit&, const Instance& instance) { prefetch(&instance.mesh); });
  for_each_hit([&](const Hit& hit, const Instance& instance) {
    if (!instance.in_world_space) prefetch(&instance.to_world);
    prefetch(&triangle_of(hit, instance));
  });
  for_each_hit([&](const Hit& hit, const Instance& instance) {
    const UVec3& corners = triangle_of(hit, instance);
    for (int c = 0; c < 3; ++c) prefetch(&scene.vertices[corners[c]]);
  });
}

}  // namespace relume
