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
  std::vector<Rgb> pixels;  ///< width · height, row by row from the top

  Image() = default;
  Image(int w, int h) : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h), Rgb(0)) {}
  Rgb& at(int x, int y) { return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)]; }
  const Rgb& at(int x, int y) const {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

/// Pixels [x, x + width) × [y, y + height) of an image; empty: the whole image.
struct PixelWindow {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool empty() const { return width == 0; }
  friend bool operator==(const PixelWindow&, const PixelWindow&) = default;
};

/// Memory layout of an image's pixels.
enum class PixelLayout {
  rgb32f,   ///< 3 floats, linear radiance
  rgba32f,  ///< 4 floats, linear radiance and alpha 1
  rgba8,    ///< 4 bytes for display: tone-mapped, sRGB-encoded, alpha 255
};

/// The caller's memory for an image. Row 0 is the top row.
struct ImageTarget {
  void* pixels = nullptr;
  int width = 0;
  int height = 0;
  size_t row_stride = 0;  ///< bytes from one row to the next; 0: tightly packed rows
  PixelLayout layout = PixelLayout::rgb32f;
};

/// Bytes per pixel.
constexpr size_t pixel_bytes(PixelLayout layout) {
  return layout == PixelLayout::rgb32f ? 12 : layout == PixelLayout::rgba32f ? 16 : 4;
}

}  // namespace relume
