// Exposure from the image itself, as a camera meters it.
#pragma once

#include <span>

#include "core/vec.h"

namespace relume {

/// Stops by which an image is brightened: middle grey (0.18) over the geometric mean of the luminance between its 10th
/// and 95th percentiles, limited so that the 99th percentile stays below 2^4 times middle grey. Pixels that are black
/// or not finite do not count; 0 if none is left, and within ±16. Looks at up to 131,072 pixels.
float auto_exposure(std::span<const Rgb> radiance);

}  // namespace relume
