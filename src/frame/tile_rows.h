// Tiles of kernels that compute kLanes elements of a row at once on the host.
#pragma once

#include "core/lanes.h"
#include "frame/launch.h"

namespace relume {

/// Calls lanes(x, y) for each block of kLanes elements (x … x + kLanes − 1, y) of the tile. Calls single(x, y) for the
/// elements of blocks where lanes() returned false, and for the rest of each row, which is shorter than a block.
template <typename LanesWork, typename Single>
inline void for_each_in_rows(const Tile& tile, const LanesWork& lanes, const Single& single) {
  for (uint32_t y = tile.y0; y < tile.y1; ++y) {
    uint32_t x = tile.x0;
    for (; x + kLanes <= tile.x1; x += kLanes) {
      if (lanes(x, y)) continue;
      for (uint32_t k = 0; k < kLanes; ++k) single(x + k, y);
    }
    for (; x < tile.x1; ++x) single(x, y);
  }
}

}  // namespace relume
