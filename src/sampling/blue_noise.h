// A tile of blue noise for dithered sampling ([Georgiev16]): neighbouring pixels take numbers that differ much, so that
// their errors cancel in any filter, the eye's included.
#pragma once

#include <cstdint>

#include "core/hash.h"
#include "core/view.h"

namespace relume {

/// Edge of the tile, pixels; it repeats.
inline constexpr uint32_t kBlueNoiseEdge = 64;

/// The tile: each of the numbers 0 … kBlueNoiseEdge² − 1 once, row by row. Computed once, by void and cluster
/// ([Ulichney93]); lives as long as the program.
View<const uint16_t> blue_noise_tile();

/// Shifts in [0, 1) of one pixel's numbers, one a dimension: the tile's value at the pixel, where the tile is moved by
/// an amount of its own for each dimension.
struct BlueNoisePixel {
  View<const uint16_t> tile;
  uint32_t x = 0;
  uint32_t y = 0;

  RELUME_HD_INLINE float shift(uint32_t dimension_seed) const {
    constexpr uint32_t kMask = kBlueNoiseEdge - 1;
    const uint32_t offset = hash(dimension_seed);
    const uint32_t column = (x + (offset & 0xffffu)) & kMask;
    const uint32_t row = (y + (offset >> 16)) & kMask;
    return (static_cast<float>(tile[row * kBlueNoiseEdge + column]) + 0.5f) / (kBlueNoiseEdge * kBlueNoiseEdge);
  }
};

}  // namespace relume
