// Daylight: the sky of Preetham, Shirley and Smits [Preetham99] baked into an environment map, and the sun as a
// directional light with its true angular size. A radiance of 1 is 1 kcd/m², an irradiance of 1 is 1 klx.
#pragma once

#include <vector>

#include "lights/directional_light.h"
#include "scene/scene.h"

namespace relume {

struct SunSkyModel {
  std::vector<Rgb> sky;  ///< equirectangular, as in Environment::map; the ground fills the lower half
  int width = 0;
  int height = 0;
  DirectionalLight sun;
};

SunSkyModel make_sun_sky(const SunSky& parameters);

/// Unit vector towards the sun.
Vec3 sun_direction(const SunSky& parameters);

/// Radiance of the sky in direction `w` (w.y > 0).
Rgb sky_radiance(const SunSky& parameters, const Vec3& w);

}  // namespace relume
