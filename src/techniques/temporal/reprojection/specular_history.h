// The specular part of backward reprojection, looked up at the previous position of the image in a reflection. The rest
// of the mean moves with the surface.
#pragma once

#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// Moves the specular part of the mean; InterpolatedHistory moves the rest.
struct SpecularHistoryKernel {
  BackwardReprojection reflections;
  View<const Rgb> before;
  View<const uint32_t> samples_before;
  View<Rgb> now;
  View<uint32_t> samples;
  uint32_t max_samples = 1;  ///< maximum sample count of a history

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * reflections.width + x;
    const BackwardTaps taps = reflections.taps(x, y);
    const uint32_t known = taps.least(samples_before);
    samples[pixel] = relume::min(known, max_samples);
    now[pixel] = known > 0 ? taps.fetch(before) : Rgb(0);
  }
};

}  // namespace relume
