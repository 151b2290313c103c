// Axis-aligned boxes.
#pragma once

#include "core/vec.h"

namespace relume {

/// Axis-aligned box; empty at first.
struct Box {
  Vec3 low{kInfinity};
  Vec3 high{-kInfinity};

  bool empty() const { return low.x > high.x; }

  void add(const Vec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  void add(const Box& box) {
    low = glm::min(low, box.low);
    high = glm::max(high, box.high);
  }

  // Only for boxes that are not empty.
  Vec3 center() const { return 0.5f * (low + high); }
  Vec3 extent() const { return high - low; }

  /// Length from corner to corner; 0 for an empty box.
  float diagonal() const { return empty() ? 0.0f : glm::length(extent()); }
};

/// Bounding box of the corners of `box` under an affine matrix. It contains the transformed content. Empty stays empty.
inline Box transformed(const Box& box, const Mat4& to_world) {
  Box result;
  if (box.empty()) return result;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                 (corner & 4) != 0 ? box.high.z : box.low.z);
    result.add(transform_point(to_world, p));
  }
  return result;
}

}  // namespace relume
