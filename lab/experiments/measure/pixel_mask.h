// Image regions, and errors in them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "compare/reference.h"
#include "relume/image_io.h"

namespace relume {

/// A rectangle in fractions of the image's width and height from the upper left corner.
struct Rectangle {
  std::string name;
  double x0 = 0;
  double y0 = 0;
  double x1 = 1;
  double y1 = 1;
};

/// Pixels [x0, x1) × [y0, y1).
struct PixelRange {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};
/// Pixels of a rectangle in an image of this size.
PixelRange pixels_of(const Rectangle& rectangle, int width, int height);

/// Set of image pixels.
struct PixelMask {
  std::string name;
  std::vector<uint8_t> mask;  ///< per pixel, in rows; 0: outside

  size_t pixels() const;
};
/// pixels_of() as a mask with the rectangle's name.
PixelMask mask_of(const Rectangle& rectangle, int width, int height);

/// Mean of `value` over the indices of the region's pixels; 0 without pixels.
template <typename Value>
double mean_over(const PixelMask& region, const Value& value) {
  double sum = 0;
  for (size_t p = 0; p < region.mask.size(); ++p) {
    if (region.mask[p] != 0) sum += value(p);
  }
  return sum / static_cast<double>(std::max<size_t>(region.pixels(), 1));
}

/// Mean over the region's pixels and over R, G and B. Here and below, the image has the mask's size.
double mean_of_channels(const Image& image, const PixelMask& region);

/// MSE of a frame in a region: mean over its pixels and over R, G and B of (frame − reference)².
double frame_mse(const Image& frame, const Image& reference, const PixelMask& region);

/// Estimated contribution of the reference's noise to frame_mse(); 0 if unknown.
double reference_noise(const Reference& reference, const PixelMask& region);

}  // namespace relume
