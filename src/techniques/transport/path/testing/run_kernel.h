// Runs the two kernels of a path, one after the other, for tests that compare the forms of the second.
#pragma once

#include <algorithm>

#include "techniques/transport/path/path_kernel.h"

namespace relume::testing {

/// Primary hits of width × height pixels and their paths, pixel by pixel (`tile_size` 0) or in tiles.
template <typename Kernel>
void run_kernel(const PrimaryHitsKernel& primary, const Kernel& kernel, uint32_t width, uint32_t height,
                uint32_t tile_size) {
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      primary(x, y);
      if (tile_size == 0) kernel(x, y);
    }
  }
  for (uint32_t y = 0; tile_size > 0 && y < height; y += tile_size) {
    for (uint32_t x = 0; x < width; x += tile_size)
      kernel(Tile{x, y, std::min(x + tile_size, width), std::min(y + tile_size, height)});
  }
}

}  // namespace relume::testing
