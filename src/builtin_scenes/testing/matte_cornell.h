// The Cornell box with other materials, for tests of techniques that depend on them.
#pragma once

#include "builtin_scenes/builtin.h"

namespace relume::testing {

/// The Cornell box without gloss.
inline Scene matte_cornell() {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    m.roughness = 1;
    m.metallic = 0;
    m.specular = 0;
  }
  return scene;
}

/// The box with metal boxes and white walls of metal. Their lobes are too narrow for cells and for joints.
inline Scene with_metal(Scene cornell) {
  for (Material& m : cornell.materials) {
    if (m.name != "white" && m.name != "boxes") continue;
    m.metallic = 1;
    m.roughness = 0.15f;
  }
  return cornell;
}

/// The box below a smooth coat.
inline Scene with_coat(Scene cornell) {
  for (Material& m : cornell.materials) {
    m.base_color = glm::max(m.base_color, Rgb(0.01f));  // caches raise black
    m.clearcoat = 1;
    m.clearcoat_roughness = 0;
  }
  return cornell;
}

}  // namespace relume::testing
