// Estimates how well the finite lights of a scene light its visible surfaces.
#pragma once

#include "scene/scene_view.h"

namespace relume {

/// Direct irradiance at the visible surfaces, summed over a grid of pixels; luminance, up to a common factor.
struct ViewLighting {
  float finite = 0;      ///< from emissive surfaces, point and spot lights
  float infinite = 0;    ///< from directional lights and the environment
  float comparable = 0;  ///< from finite lights, per pixel at most the irradiance from infinity

  /// Whether finite lights contribute at least this share of the irradiance from infinity; true if that is zero. Each
  /// pixel's irradiance is clamped to that from infinity, because a surface next to its lamp does not represent the
  /// others.
  bool finite_lights_give(float share) const { return comparable >= share * infinite; }
};

/// Estimates the irradiances with shadow rays, which transmissive surfaces block. Deterministic to the bit. Needs
/// `scene.accel`.
ViewLighting estimate_view_lighting(const SceneView& scene);

}  // namespace relume
