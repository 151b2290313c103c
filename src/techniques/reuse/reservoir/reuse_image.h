// Planes to which reservoirs add their light, and the pixels that have paths.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// The pixels that have a path in this frame.
struct SampledPixels {
  View<const uint32_t> allocation = {};  ///< paths of each pixel, 0 or 1; empty: all have one

  RELUME_HD bool has(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }
};

struct ReuseImage {
  View<Rgb> radiance;
  View<Rgb> specular;  ///< part from specular lobes; may be empty
  View<uint32_t> rays;
  SampledPixels sampled = {};  ///< that receive light

  /// Whether a reservoir of this weight adds light to the pixel. Adds a weight that is not finite to the radiance,
  /// where such values are counted.
  RELUME_HD bool takes(float weight, uint32_t pixel) const {
    if (weight == 0.0f) return false;
    if (is_finite(weight)) return true;
    radiance[pixel] += Rgb(weight);
    return false;
  }
};

}  // namespace relume
