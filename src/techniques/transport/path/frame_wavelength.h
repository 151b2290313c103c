// One wavelength for all paths of a frame, for techniques that join paths of different pixels.
#pragma once

#include <cmath>

#include "core/hash.h"
#include "sampling/sample_index.h"
#include "scene/dispersion.h"

namespace relume {

/// Wavelength of the frame, nanometres. The wavelengths of successive frames are evenly distributed.
inline float frame_wavelength(const SampleIndex& index) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  const double start = static_cast<double>(to_unit_float(hash(index.seed, index.sequence)));
  const double u = start + kGoldenRatio * index.sample;
  return sample_wavelength(static_cast<float>(u - std::floor(u)));
}

}  // namespace relume
