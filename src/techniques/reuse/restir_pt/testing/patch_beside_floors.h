// A scene of specular and diffuse surfaces whose only light comes from a small bright patch.
#pragma once

#include "builtin_scenes/shapes.h"
#include "scene/testing/media.h"

namespace relume::testing {

/// A floor seen from above, whose right half is a mirror, below a ceiling that is out of view. A spot light shines down
/// at a patch of 0.2 m radius on the floor, out of view, too. Its light reaches the camera over the ceiling, by three
/// reflections.
inline Scene patch_beside_floors() {
  Scene scene = plate(matte(Rgb(0.8f)), 3, 1);
  Material mirror = matte(Rgb(0.9f));
  mirror.metallic = 1;
  mirror.roughness = 0;
  add_mesh(scene, mirror, quad({0, 0.01f, 1}, {1, 0, 0}, {0, 0, -2}));
  add_mesh(scene, matte(Rgb(0.8f)), quad({-3, 2, -3}, {6, 0, 0}, {0, 0, 6}));
  PunctualLight lamp;
  lamp.type = PunctualType::spot;
  lamp.intensity = Rgb(100);
  lamp.inner_cone_rad = 0.15f;
  lamp.outer_cone_rad = 0.2f;
  scene.lights.push_back(lamp);
  Node node;
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  node.transform.translation = Vec3(0, 1, 1.8f);
  node.transform.rotation = glm::angleAxis(-kPi / 2, Vec3(1, 0, 0));  // from -Z to -Y
  scene.add_node(node);
  return scene;
}

}  // namespace relume::testing
