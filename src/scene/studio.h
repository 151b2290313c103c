// A neutral photo studio as an environment: three soft boxes before a dim backdrop. It lights models that bring no
// light.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace relume {

struct EnvironmentMap {
  int width = 0;
  int height = 0;
  std::vector<Rgb> texels;  ///< radiance, as Environment::map
};

/// The studio for a camera at azimuth 0, which looks along -Z: the key light stands behind the camera to its left, the
/// fill light to its right, the rim light beyond the object. The backdrop is darker than the key light, so that pale
/// objects stand out against it, and metals mirror the edges of the boxes.
EnvironmentMap make_studio();

/// Environment::rotation_rad with which the studio faces a camera that looks along `forward`; 0 for a camera that looks
/// straight up or down.
float studio_rotation_rad(const Vec3& forward);

}  // namespace relume
