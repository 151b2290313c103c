// Detects pixels at edges of emission, where caches and denoisers trace more camera rays. Filters do not average
// emission, so its noise there would outweigh the noise that they remove. Only the eight neighbours decide, because
// using the pixel's own sample would add bias.
#pragma once

#include "core/vec.h"
#include "sampling/sample_index.h"
#include "sampling/sampler.h"

namespace relume {

/// An edge: emission differs by more than this multiple of the darkest radiance.
inline constexpr float kEmissionContrast = 4;
inline constexpr uint32_t kNeighbours = 8;

/// Index `i` of the k-th of the eight neighbours of (x, y). Returns false outside the image.
RELUME_HD inline bool neighbour_of(uint32_t k, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t& i) {
  const uint32_t cell = k < 4 ? k : k + 1;  // in a block of 3 × 3 without its centre
  const uint32_t nx = x + cell % 3 - 1;     // wraps around beyond the left and the upper edge
  const uint32_t ny = y + cell / 3 - 1;
  i = ny * width + nx;
  return nx < width && ny < height;
}

/// Largest difference of `emission(i)`, the luminance emitted in pixel i, among the neighbours.
template <typename Emission>
RELUME_HD inline float emission_contrast(uint32_t x, uint32_t y, uint32_t width, uint32_t height,
                                         const Emission& emission) {
  float least = kInfinity;
  float most = 0;
  uint32_t i = 0;
  for (uint32_t k = 0; k < kNeighbours; ++k) {
    if (!neighbour_of(k, x, y, width, height, i)) continue;
    const float seen = emission(i);
    least = relume::min(least, seen);
    most = relume::max(most, seen);
  }
  return most > least ? most - least : 0.0f;
}

/// Minimum of `radiance(i)`, the luminance of pixel i, among the neighbours.
template <typename Radiance>
RELUME_HD inline float darkest_around(uint32_t x, uint32_t y, uint32_t width, uint32_t height,
                                      const Radiance& radiance) {
  float darkest = kInfinity;
  uint32_t i = 0;
  for (uint32_t k = 0; k < kNeighbours; ++k) {
    if (neighbour_of(k, x, y, width, height, i)) darkest = relume::min(darkest, radiance(i));
  }
  return darkest;
}

/// Mean of `emission(sampler)`, the emission along a camera ray, over `rays` additional rays of pixel (x, y). Their
/// sequence spans all frames, because their number does not adapt.
template <typename Emission>
RELUME_HD inline Rgb mean_emission(const SampleIndex& index, uint32_t rays, uint32_t x, uint32_t y,
                                   const Emission& emission) {
  constexpr uint32_t kSalt = 0x5bd1e995u;
  const uint32_t first = index.age * rays;
  Rgb sum(0);
  for (uint32_t k = 0; k < rays; ++k) {
    Sampler sampler = Sampler::sequence(index.seed ^ kSalt, x, y, first + k);
    sum += emission(sampler);
  }
  return sum / static_cast<float>(rays);
}

}  // namespace relume
