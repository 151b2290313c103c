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
  bool operator==(const Tile&) const = default;
};

/// Grid of elements, in square tiles. The last column and row may be narrower.
struct LaunchTiles {
  uint32_t width = 0;      ///< elements
  uint32_t height = 0;     ///< elements
  uint32_t tile_size = 0;  ///< edge of a tile, elements; 0: no grid

  uint32_t columns() const { return width / tile_size + (width % tile_size > 0 ? 1 : 0); }
  uint32_t rows() const { return height / tile_size + (height % tile_size > 0 ? 1 : 0); }
  uint32_t tiles() const { return columns() * rows(); }
  /// Tile `index` < tiles(), by rows.
  Tile tile(uint32_t index) const {
    const uint32_t x = index % columns() * tile_size;
    const uint32_t y = index / columns() * tile_size;
    return {x, y, x + (width - x < tile_size ? width - x : tile_size),
            y + (height - y < tile_size ? height - y : tile_size)};
  }
};

}  // namespace relume
