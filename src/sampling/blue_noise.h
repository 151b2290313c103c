// A tile of blue noise for dithered sampling ([Georgiev16]). Neighbouring pixels get very different numbers, so their
// errors cancel in any filter, including the eye.
#pragma once

#include <cstdint>

#include "core/array.h"
#include "core/hash.h"
#include "core/view.h"

namespace relume {

/// Edge of the repeating tile, pixels.
inline constexpr uint32_t kBlueNoiseEdge = 64;

/// The tile contains each number 0 … kBlueNoiseEdge² − 1 once, row by row. Computed once by void and cluster
/// ([Ulichney93]); lives until the program ends. For host code.
View<const uint16_t> blue_noise_tile();

/// The tile in the memory of `array`, which is filled if it is empty.
View<const uint16_t> blue_noise_tile(Array<uint16_t>& array);

/// Shifts in [0, 1) of one pixel's numbers, one per dimension: the tile's value at the pixel. The tile is offset by a
/// separate amount for each dimension.
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
