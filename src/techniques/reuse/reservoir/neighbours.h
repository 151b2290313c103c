// Neighbouring pixels whose reservoirs a pixel reuses.
#pragma once

#include "core/math.h"
#include "core/vec.h"
#include "core/view.h"
#include "techniques/reuse/reservoir/reservoir.h"
#include "techniques/reuse/reservoir/settings.h"

namespace relume {

/// Tolerances of neighbours ([Bitterli20]): cosine between the normals, and difference of the depths as a fraction.
inline constexpr float kReuseNormalCosine = 0.5f;
inline constexpr float kReuseDepthDifference = 0.1f;

/// Offset of neighbour `i` of a pixel, uniform over a disk of radius 1: points of the sequence R2 ([Roberts18]) after a
/// shift.
RELUME_HD inline Vec2 neighbour_offset(uint32_t i, const Vec2& shift) {
  constexpr float kStepX = 0.7548776662f;
  constexpr float kStepY = 0.5698402910f;
  const auto n = static_cast<float>(static_cast<int>(i));
  const float a = shift.x + kStepX * n;
  const float b = shift.y + kStepY * n;
  const Vec2 direction = math::unit_vector((b - std::floor(b)) * (2.0f * kPi));
  return direction * std::sqrt(a - std::floor(a));
}

struct ReuseNeighbours {
  uint32_t pixels[kMostReuseNeighbours];
  uint32_t count = 0;
};

/// Finds neighbours by their surfaces. A choice by their samples would add bias.
struct NeighbourSearch {
  View<const Vec3> normal;
  View<const float> depth;
  uint32_t count = 0;  ///< at most kMostReuseNeighbours
  float radius = 0;    ///< pixels
  uint32_t width = 0;
  uint32_t height = 0;

  /// Adds pixels near (x, y) with similar surfaces. `has_reservoir(pixel)`: whether its surface can have a sample.
  template <typename HasReservoir>
  RELUME_HD void find(uint32_t x, uint32_t y, const HasReservoir& has_reservoir, ChoiceNumbers& numbers,
                      ReuseNeighbours& near) const {
    const uint32_t pixel = y * width + x;
    const float shift_x = numbers.next();
    const Vec2 shift(shift_x, numbers.next());
    for (uint32_t i = 0; i < count; ++i) {
      const Vec2 offset = neighbour_offset(i, shift) * radius;
      const float fx = std::floor(static_cast<float>(static_cast<int>(x)) + offset.x + 0.5f);
      const float fy = std::floor(static_cast<float>(static_cast<int>(y)) + offset.y + 0.5f);
      const auto w = static_cast<float>(static_cast<int>(width));
      const auto h = static_cast<float>(static_cast<int>(height));
      if (!(fx >= 0.0f && fy >= 0.0f && fx < w && fy < h)) continue;
      const uint32_t other = static_cast<uint32_t>(fy) * width + static_cast<uint32_t>(fx);
      if (other != pixel && has_reservoir(other) && similar(pixel, other)) near.pixels[near.count++] = other;
    }
  }

  /// Whether pixel `other` can be a neighbour of `pixel` by its surface.
  RELUME_HD bool similar(uint32_t pixel, uint32_t other) const {
    return glm::dot(normal[pixel], normal[other]) >= kReuseNormalCosine &&
           std::fabs(depth[other] - depth[pixel]) <= kReuseDepthDifference * depth[pixel];
  }
};

}  // namespace relume
