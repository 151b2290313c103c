// Planes to which reservoirs add their light.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

struct ReuseImage {
  View<Rgb> radiance;
  View<Rgb> specular;  ///< part from specular lobes; may be empty
  View<uint32_t> rays;

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
