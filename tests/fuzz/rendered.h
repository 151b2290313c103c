// What parsers accept has to render, too.
#pragma once

#include "render/session.h"

namespace relume::fuzz {

/// Two frames of two by two pixels. A scene that cannot be rendered ends in an Error; whatever it says of cameras,
/// materials and textures, sanitizers look at what becomes of it.
inline void render_two_frames(Scene scene) {
  // A small file may well ask for millions, and for built-in scenes that have them.
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
