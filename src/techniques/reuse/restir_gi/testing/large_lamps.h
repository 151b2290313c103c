// Built-in scenes with less noise.
#pragma once

#include <string>

#include "builtin_scenes/builtin.h"
#include "core/vec.h"
#include "relume/scene.h"

namespace relume::testing {

/// A built-in scene under lamps that paths often hit. They have the flux of the scene's own.
inline Scene under_large_lamps(const std::string& name) {
  constexpr float kScale = 8;
  Scene scene = find_builtin_scene(name)->build();
  if (name == "cornell") return scene;  // has a large lamp
  for (Mesh& mesh : scene.meshes) {
    if (mesh.material == kNone || is_black(scene.materials[static_cast<size_t>(mesh.material)].emission)) continue;
    for (Vec3& p : mesh.positions) p *= Vec3(kScale, 1, kScale);
    scene.materials[static_cast<size_t>(mesh.material)].emission /= sqr(kScale);
  }
  return scene;
}

}  // namespace relume::testing
