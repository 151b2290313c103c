// Parts of a picture, pixel by pixel.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/reference.h"
#include "io/image.h"

namespace relume {

/// A part of the picture.
struct PixelMask {
  std::string name;
  std::vector<uint8_t> mask;  ///< by pixel, row by row; 0: outside

  size_t pixels() const;
};

/// MSE of one frame in one region: mean over its pixels and over R, G and B of (frame − reference)².
double frame_mse(const Image& frame, const Image& reference, const PixelMask& region);

/// What the reference's own noise adds to frame_mse(), by its estimate; 0 if that is not known.
double reference_noise(const Reference& reference, const PixelMask& region);

}  // namespace relume
