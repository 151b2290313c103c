// Where something bright ends, one camera ray in a pixel sees all of it or nothing. No filter averages emission, so the
// noise of such pixels would outweigh whatever a filter removes elsewhere: they deserve more camera rays.
#pragma once

#include "core/vec.h"

namespace relume {

/// Neighbours differ if their emission does by more than this multiple of the darkest one's radiance.
inline constexpr float kEmissionContrast = 4;
inline constexpr uint32_t kNeighbours = 8;

/// The k-th of the eight pixels around (x, y). False outside of the picture.
RELUME_HD inline bool neighbour_of(uint32_t k, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t& i) {
  const uint32_t cell = k < 4 ? k : k + 1;  // of a block of nine, without its middle
  const uint32_t nx = x + cell % 3 - 1;     // wraps around beyond the left and the upper edge
  const uint32_t ny = y + cell / 3 - 1;
  i = ny * width + nx;
  return nx < width && ny < height;
}

/// Whether something bright ends around pixel (x, y). `emission(i)` and `radiance(i)`: luminance of pixel i, of the
/// emission that it sees and of all that it shows. The pixel's own sample has no say, or what it saw would be counted
/// more or less often than it deserves.
template <typename Emission, typename Radiance>
RELUME_HD inline bool is_emission_edge(uint32_t x, uint32_t y, uint32_t width, uint32_t height,
                                       const Emission& emission, const Radiance& radiance) {
  float least = kInfinity;
  float most = 0;
  uint32_t i = 0;
  for (uint32_t k = 0; k < kNeighbours; ++k) {
    if (!neighbour_of(k, x, y, width, height, i)) continue;
    const float seen = emission(i);
    least = relume::min(least, seen);
    most = relume::max(most, seen);
  }
  if (!(most > least)) return false;
  float darkest = kInfinity;
  for (uint32_t k = 0; k < kNeighbours; ++k) {
    if (neighbour_of(k, x, y, width, height, i)) darkest = relume::min(darkest, radiance(i));
  }
  return most - least > kEmissionContrast * darkest;
}

}  // namespace relume
