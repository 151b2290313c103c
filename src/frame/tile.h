// Rectangles of a grid.
#pragma once

#include <cstdint>

namespace relume {

/// Edge of a grid's tiles, elements.
inline constexpr uint32_t kTileSize = 16;

/// Elements [x0, x1) × [y0, y1) of a grid.
struct Tile {
  uint32_t x0 = 0;
  uint32_t y0 = 0;
  uint32_t x1 = 0;
  uint32_t y1 = 0;

  uint32_t width() const { return x1 - x0; }
  uint32_t height() const { return y1 - y0; }
};

}  // namespace relume
