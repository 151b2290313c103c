// Renders scenes that parsers accept.
#pragma once

#include "render/session.h"

namespace relume::fuzz {

/// Renders two frames of 2 × 2 pixels, with all cameras, materials and textures under sanitizers. A scene that cannot
/// be rendered gives an Error.
inline void render_two_frames(Scene scene) {
  // Small files can contain millions of instances, or reference large built-in scenes.
  constexpr size_t kMost = 1 << 16;
  size_t instances = 0;
  for (const Node& node : scene.nodes) instances += node.instances.size() * node.meshes.size();
  size_t triangles = 0;
  for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
  if (instances > kMost || triangles > kMost) return;
  RenderSettings settings;
  settings.width = settings.height = 2;
  settings.threads = 1;
  settings.path.max_bounces = 2;
  Session session(std::move(scene), settings);
  for (int i = 0; i < 2; ++i) session.render_frame();
}

}  // namespace relume::fuzz
