// What the path of a pixel tells light selections that learn per pixel.
#pragma once

#include "core/math.h"
#include "core/vec.h"
#include "lights/light.h"

namespace relume {

/// A reservoir of one light: chosen among the unblocked connections of the pixel's path, by their contributions. With
/// the first surface of the path. Passes may add reservoirs of earlier frames.
struct LightFeedback {
  static constexpr uint32_t kLater = 0x80000000u;  ///< flag in `light`: connected to a vertex after the first

  uint32_t light = kNoLight;          ///< with kLater; kNoLight: none
  float weight = 0;                   ///< sum of the contributions, luminance
  Vec3 position{kInfinity};           ///< of the first surface, metres; not finite: the path met none
  Vec3 previous_position{kInfinity};  ///< of the same material point in the frame before

  RELUME_HD bool has_surface() const { return is_finite(position); }
  /// The light; above all ids if there is none.
  RELUME_HD LightId id() const { return light & ~kLater; }
  /// Whether the light was connected to the first vertex.
  RELUME_HD bool is_direct() const { return (light & kLater) == 0; }

  /// Adds an unblocked connection. `u`: uniform in [0, 1). Contributions that are not positive and finite are ignored.
  RELUME_HD void offer(LightId id, bool later, float contribution, float u) {
    if (!(contribution > 0.0f) || !is_finite(weight + contribution)) return;
    weight += contribution;
    if (u * weight < contribution) light = later ? id | kLater : id;
  }
};

}  // namespace relume
