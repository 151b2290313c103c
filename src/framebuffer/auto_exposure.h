// Automatic exposure from the image, as a camera meters it.
#pragma once

#include <cstddef>
#include <span>

#include "core/vec.h"

namespace relume {

/// Exposure in stops that maps the geometric mean luminance between the 10th and 95th percentiles to middle grey
/// (0.18). Limited so that the 99th percentile stays below 2^4 times middle grey, and to ±16. Ignores black and
/// non-finite pixels; 0 if no pixel remains. Samples up to 131,072 pixels.
float auto_exposure(std::span<const Rgb> radiance);

/// auto_exposure() reads each pixel whose index is a multiple of this number. It returns the same for these pixels
/// alone.
size_t metering_stride(size_t pixels);

}  // namespace relume
