// How well the finite lights of a scene light what its camera sees.
#pragma once

#include "scene/scene_view.h"

namespace relume {

/// Direct irradiance at the visible surfaces, summed over a grid of pixels; luminance, up to a common factor.
struct ViewLighting {
  float finite = 0;      ///< from emissive surfaces, point and spot lights
  float infinite = 0;    ///< from directional lights and the environment
  float comparable = 0;  ///< from finite lights, in each pixel at most what comes from infinity

  /// Whether finite lights give at least this share of what comes from infinity, or nothing comes from there. A surface
  /// that glows next to its lamp says nothing about the others, so no pixel counts more than what reaches it from
  /// infinity.
  bool finite_lights_give(float share) const { return comparable >= share * infinite; }
};

/// Estimates it with shadow rays, which transmissive surfaces block. Deterministic: the same scene gives the same bits.
/// Needs `scene.accel`.
ViewLighting estimate_view_lighting(const SceneView& scene);

}  // namespace relume
