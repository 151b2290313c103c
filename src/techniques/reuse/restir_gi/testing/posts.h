// A scene whose image is indirect light only, with occlusion that differs from pixel to pixel.
#pragma once

#include <utility>

#include "builtin_scenes/shapes.h"
#include "scene/testing/media.h"

namespace relume::testing {

/// A spot light that shines up from the origin.
inline PunctualLight ceiling_lamp(const Rgb& intensity) {
  PunctualLight lamp;
  lamp.type = PunctualType::spot;
  lamp.intensity = intensity;
  lamp.inner_cone_rad = 0.8f;
  lamp.outer_cone_rad = 1.1f;
  return lamp;
}

/// A floor with posts, seen from above, below a ceiling that is out of view. The lamp is between camera and ceiling,
/// and only shines at the ceiling. Its light reaches the floor by one reflection.
inline Scene posts_below(const Material& floor, const Material& ceiling) {
  Scene scene = plate(floor, 3, 1);
  Mesh posts;
  for (int i = 0; i < 64; ++i) {
    const float x = -0.9f + 0.25f * static_cast<float>(i % 8);
    const float z = -0.9f + 0.25f * static_cast<float>(i / 8);
    append(posts, box({x, 0, z}, {x + 0.06f, 0.3f, z + 0.06f}));
  }
  add_mesh(scene, matte(Rgb(0.5f, 0.6f, 0.7f)), std::move(posts));
  add_mesh(scene, ceiling, quad({-3, 2, -3}, {6, 0, 0}, {0, 0, 6}));
  scene.lights.push_back(ceiling_lamp(Rgb(20)));
  Node node;
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  node.transform.translation = Vec3(0.3f, 1, 0.2f);
  node.transform.rotation = glm::angleAxis(kPi / 2, Vec3(1, 0, 0));  // from -Z to +Y
  scene.add_node(node);
  return scene;
}

inline Scene posts() { return posts_below(matte(Rgb(0.7f, 0.5f, 0.4f)), matte(Rgb(0.8f, 0.7f, 0.6f))); }

}  // namespace relume::testing
