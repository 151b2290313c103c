// Opacity of surfaces. Included by surface_point_impl.h.
#pragma once

#include "scene/surface_point.h"

namespace relume {

RELUME_HD inline float opacity(const SceneView& scene, uint32_t instance_index, uint32_t primitive, float u, float v) {
  using namespace surface_detail;
  const MeshView& mesh = scene.meshes[scene.instances[instance_index].mesh];
  const MaterialData& material = scene.materials[mesh.material];
  if (!material.has_alpha()) return 1.0f;
  const TriangleAt t = triangle_at(scene, mesh, primitive, u, v);
  float alpha = material.alpha;
  if (material.base_color_texture.used()) {
    const TextureUse& use = material.base_color_texture;
    const Vec2 uv = uv_set(scene, mesh, t, use.uv_set).at(t.weights);
    alpha *= scene.textures.sample_level(static_cast<uint32_t>(use.texture), use.transform(uv), 0).w;
  }
  if (mesh.has_colors) {
    const uint32_t first = mesh.first_color;
    alpha *= interpolate(scene.colors[first + t.index.x], scene.colors[first + t.index.y],
                         scene.colors[first + t.index.z], t.weights)
                 .w;
  }
  if (material.mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
  return saturate(alpha);
}

}  // namespace relume
