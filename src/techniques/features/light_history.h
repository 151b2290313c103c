// What denoisers remember of a pixel: the light that arrives at its surface, accumulated over frames along with the
// surface's motion.
#pragma once

#include "techniques/features/features.h"

namespace relume {

/// What a frame's sample says of the light at a pixel's surface.
struct SurfaceLightSample {
  Rgb light{0};
  bool valid = false;  ///< false: no path this frame, nothing to filter, or not finite
};

/// Views on this frame's samples and features.
struct SurfaceLight {
  View<const Rgb> radiance;
  View<const uint32_t> allocation;  ///< samples of the pixel in this frame, 0 or 1; empty: 1
  View<const Rgb> albedo;
  View<const Rgb> emission;

  RELUME_HD bool taken(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }

  RELUME_HD SurfaceLightSample at(uint32_t pixel) const {
    if (!taken(pixel) || !is_filtered(albedo[pixel]) || !is_finite(radiance[pixel])) return {};
    return {demodulate(radiance[pixel], emission[pixel], albedo[pixel]), true};
  }

  /// The picture from filtered light. What is not filtered shows this frame's sample or, without one, the emission
  /// seen. Samples that miss some of the emission leave negative light behind; no picture is darker than black.
  RELUME_HD Rgb picture(uint32_t pixel, const Rgb& light) const {
    if (is_filtered(albedo[pixel])) return glm::max(emission[pixel] + albedo[pixel] * light, Rgb(0));
    return taken(pixel) && is_finite(radiance[pixel]) ? radiance[pixel] : emission[pixel];
  }
};

inline constexpr uint32_t kNoHistoryLimit = 1u << 24;  ///< counts above are no longer exact as floats

}  // namespace relume
