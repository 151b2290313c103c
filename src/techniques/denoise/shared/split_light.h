// Splits this frame's samples into diffuse and specular light, for denoisers that keep them apart.
#pragma once

#include "core/lane_views.h"
#include "frame/tile_rows.h"
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

  /// Host: kLanes pixels at once.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      split_lanes(y * width + x);
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

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

 private:
  /// Splits the samples of kLanes pixels, from `pixel` on.
  void split_lanes(uint32_t pixel) const {
    const Triple<Lanes> all = vector_at<Lanes>(scattered, pixel);
    const LaneMask reflects = is_filtered(vector_at<Lanes>(specular_albedo, pixel));
    const LaneMask scatters = is_filtered(vector_at<Lanes>(diffuse_albedo, pixel));
    const Triple<Lanes> found = select(scatters, vector_at<Lanes>(specular_found, pixel), all);
    const Triple<Lanes> part = select(reflects, found, triple_of<Lanes>(Vec3(0)));
    set_vector(specular, pixel, part);
    set_vector(diffuse, pixel, all - part);
  }
};

}  // namespace relume
