// Where something bright ends, one camera ray in a pixel sees all of it or nothing. No filter averages emission, so the
// noise of such pixels would outweigh whatever a filter removes elsewhere: they deserve more camera rays. Whether a
// pixel is one its eight neighbours tell. Its own sample has no say, or what it saw would be counted more or less often
// than it deserves.
#pragma once

#include "core/vec.h"
#include "sampling/sample_index.h"
#include "sampling/sampler.h"

namespace relume {

/// Something bright ends where emission differs by more than this multiple of the darkest radiance.
inline constexpr float kEmissionContrast = 4;
inline constexpr uint32_t kNeighbours = 8;

/// The k-th of the eight pixels around (x, y). False outside of the image.
RELUME_HD inline bool neighbour_of(uint32_t k, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t& i) {
  const uint32_t cell = k < 4 ? k : k + 1;  // of a block of nine, without its middle
  const uint32_t nx = x + cell % 3 - 1;     // wraps around beyond the left and the upper edge
  const uint32_t ny = y + cell / 3 - 1;
  i = ny * width + nx;
  return nx < width && ny < height;
}

/// Largest difference of `emission(i)`, luminance that pixel i sees, among the neighbours.
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

/// Least `radiance(i)`, luminance that pixel i shows, among the neighbours.
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

/// Mean of `emission(sampler)`, what the camera ray of that sampler sees, over `rays` rays of pixel (x, y) beside its
/// samples. Their sequence runs through all frames, as nothing here adapts.
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
