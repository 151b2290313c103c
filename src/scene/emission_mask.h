// Black areas of emissive textures. Many emissive textures are mostly black, and triangles there emit nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "materials/texture.h"

namespace relume {

/// Counts the non-black texels of any rectangle in constant time.
class EmissionMask {
 public:
  explicit EmissionMask(const TextureSampler& texture);

  /// False only if every look-up inside the triangle with these texture coordinates is black.
  bool may_emit(const Vec2 (&uv)[3]) const;

 private:
  struct Range {
    int first = 0;
    int end = 0;
  };
  /// Texels read by look-ups between two coordinates: one range, or two across the border of a repeated texture.
  static int texel_ranges(float low, float high, int size, WrapMode wrap, Range (&ranges)[2]);
  uint32_t count(const Range& x, const Range& y) const;

  int width_;
  int height_;
  WrapMode wrap_u_;
  WrapMode wrap_v_;
  std::vector<uint32_t> sums_;  ///< (width + 1) · (height + 1): counts of non-black texels above and to the left
};

}  // namespace relume
