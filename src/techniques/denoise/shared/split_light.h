// Splits this frame's samples into diffuse and specular light, for denoisers that keep them apart.
#pragma once

#include "techniques/gbuffer/features/features.h"

namespace relume {

/// Divides a sample's light between the two histories. Emission seen directly is in neither.
struct SplitLightKernel {
  View<const Rgb> scattered;       ///< radiance without the sample's emission
  View<const Rgb> specular_found;  ///< part of `scattered` from specular lobes
  View<const Rgb> diffuse_albedo;
  View<const Rgb> specular_albedo;
  View<Rgb> diffuse;
  View<Rgb> specular;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    Rgb part = specular_found[pixel];
    if (!is_filtered(specular_albedo[pixel])) {
      part = Rgb(0);
    } else if (!is_filtered(diffuse_albedo[pixel])) {
      part = scattered[pixel];
    }
    specular[pixel] = part;
    diffuse[pixel] = scattered[pixel] - part;
  }
};

}  // namespace relume
