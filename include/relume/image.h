// Images in memory.
#pragma once

#include <cstddef>
#include <vector>

#include "relume/math.h"

namespace relume {

/// Linear RGB image; row 0 is the top row.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  ///< width · height, row by row

  Image() = default;
  Image(int w, int h) : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h), Rgb(0)) {}
  Rgb& at(int x, int y) { return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)]; }
  const Rgb& at(int x, int y) const {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

/// Pixels [x, x + width) × [y, y + height) of an image; empty: all of it.
struct PixelWindow {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool empty() const { return width == 0; }
  friend bool operator==(const PixelWindow&, const PixelWindow&) = default;
};

/// How an image's pixels lie in the caller's memory.
enum class PixelLayout {
  rgb32f,   ///< 3 floats, linear radiance
  rgba32f,  ///< 4 floats, linear radiance and alpha 1
  rgba8,    ///< 4 bytes, as a display shows them: tone-mapped, sRGB-encoded, alpha 255
};

/// Memory of the caller for an image. Row 0 is the top row.
struct ImageTarget {
  void* pixels = nullptr;
  int width = 0;
  int height = 0;
  size_t row_stride = 0;  ///< bytes from one row to the next; 0: rows follow each other
  PixelLayout layout = PixelLayout::rgb32f;
};

/// Bytes of a pixel.
constexpr size_t pixel_bytes(PixelLayout layout) {
  return layout == PixelLayout::rgb32f ? 12 : layout == PixelLayout::rgba32f ? 16 : 4;
}

}  // namespace relume
