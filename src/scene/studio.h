// A neutral photo studio as an environment: three soft boxes in front of a dim backdrop. It lights models without
// lights.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace relume {

struct EnvironmentMap {
  int width = 0;
  int height = 0;
  std::vector<Rgb> texels;  ///< radiance, as in Environment::map
};

/// Studio for a camera at azimuth 0 that looks along -Z. The key light is behind the camera to its left, the fill light
/// to its right, the rim light beyond the object. The backdrop is darker than the key light, for contrast with pale
/// objects. Metals reflect the edges of the boxes.
EnvironmentMap make_studio();

/// Environment::rotation_rad that turns the studio towards a camera along `forward`; 0 for a camera that looks straight
/// up or down.
float studio_rotation_rad(const Vec3& forward);

}  // namespace relume
