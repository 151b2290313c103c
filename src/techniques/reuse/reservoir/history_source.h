// The previous frame of a pixel's surface: the pixel whose reservoir it reuses, and the placement of its instance.
#pragma once

#include "scene/scene_view.h"
#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// The instance as it was placed in the previous frame. Meshes that deform keep their current shape.
RELUME_HD inline Instance previous_instance(const Instance& instance) {
  if (instance.in_world_space) return instance;
  Instance before = instance;
  before.to_world = instance.previous_to_world;
  before.normal_to_world = normal_matrix(before.to_world.linear);
  before.orientation = glm::dot(before.to_world.linear[0], before.normal_to_world[0]) < 0.0f ? -1.0f : 1.0f;
  return before;
}

/// The pixel that showed the surface of (x, y) in the previous frame: one of four, in proportion to its weight.
/// kNoSurface: none. `u`: uniform in [0, 1).
RELUME_HD inline uint32_t history_source(const BackwardReprojection& reprojection, uint32_t x, uint32_t y, float u) {
  const BackwardTaps taps = reprojection.taps(x, y);
  if (!taps.valid) return kNoSurface;
  float rest = u;
  for (int k = 0; k < 4; ++k) {
    if (!(taps.weights[k] > 0.0f)) continue;
    if (rest < taps.weights[k]) return taps.pixels[k];
    rest -= taps.weights[k];
  }
  return taps.heaviest();  // the weights sum to almost one
}

}  // namespace relume
