// Conservative intersection of a ray with the boxes of a node.
//
// The test never loses a triangle that ShearedRay::crosses() finds. With u = 2⁻²⁴ and M the sum of the largest
// coordinates of the triangle's corners and of the origin, in the space of the boxes, the errors per axis are at most:
//
//   6 u M  of the corners after subtraction and shear
//   2 u M  of the depth along the ray's main axis, and of the rounded distance
//   4 u M  of the planes' distances: reciprocal, product, offset and sum
//  10 u M  of the boxes: clipped triangles (9 u M) and rounded margins
//
// The sum is 22 u M. Boxes of triangles grow by kBoxMargin (24 u) times the largest coordinate of their corners when
// they are built, and the ray's offsets account for its origin. Boxes of inner nodes contain those below exactly, and
// rounding is monotonic.
#pragma once

#include "accel/bvh/layout.h"

#if !defined(__CUDACC__)
#include "accel/bvh/floats4.h"
#endif

namespace relume {

inline constexpr float kBoxMargin = 0x1.8p-20f;  // 24 u
/// In an instance, u M is measured in the world and scaled by the inverse transform. The tree's own boxes contain the
/// errors of boxes. To the other 12 u M, the transform of the corners adds 4 u M, that of the ray's origin 5 u M, and
/// that of its direction 4 u M: 25 u M in all.
inline constexpr float kInstanceMargin = 0x1p-19f;  // 32 u

/// A direction component below kParallel · margin · speed counts as parallel to the planes of its axis.
inline constexpr float kParallel = 0x1p-21f;

/// A ray in the space of boxes.
class BoxRay {
 public:
  BoxRay() = default;
  /// `origin`, `direction`: in the space of the boxes. `margin`: growth of the boxes by axis, per metre of `reach`.
  /// `reach`: bound of the world coordinates of the ray's origin and, in an instance, of its mesh, metres. `speed`:
  /// largest component of the direction in the world.
  RELUME_HD BoxRay(const Vec3& origin, const Vec3& direction, const Vec3& margin, float reach, float speed) {
    // Directions parallel to planes count as slightly inclined: the deviation is far below the margin of the axis.
    const Vec3 least = margin * (kParallel * speed);
    for (int axis = 0; axis < 3; ++axis) {
      const float d = direction[axis];
      const bool negative = d < 0.0f;
      inverse_[axis] = 1.0f / (std::fabs(d) > least[axis] ? d : (negative ? -least[axis] : least[axis]));
      const float center = -origin[axis] * inverse_[axis];
      const float slack = margin[axis] * reach * std::fabs(inverse_[axis]);
      near_[axis] = center - slack;
      far_[axis] = center + slack;
      near_row_[axis] = 2u * static_cast<uint32_t>(axis) + (negative ? 1u : 0u);
    }
  }

  /// Bit i of the result is set if the ray enters child i before `t_max`, at a distance of at least entries[i] ≥ 0.
  RELUME_HD_INLINE uint32_t enter(const BvhNode& node, float t_max, float* entries) const {
#if defined(__CUDACC__)
    return enter_one_by_one(node, t_max, entries);
#else
    return enter_at_once(node, t_max, entries);
#endif
  }

  RELUME_HD_INLINE uint32_t enter_one_by_one(const BvhNode& node, float t_max, float* entries) const {
    uint32_t entered = 0;
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      float first = 0.0f;
      float last = t_max;
      for (int axis = 0; axis < 3; ++axis) {
        const uint32_t row = near_row_[axis];
        first = max(node.bounds[row][i] * inverse_[axis] + near_[axis], first);
        last = min(node.bounds[row ^ 1u][i] * inverse_[axis] + far_[axis], last);
      }
      entries[i] = first;
      entered |= (first <= last ? 1u : 0u) << i;
    }
    return entered;
  }

#if !defined(__CUDACC__)
  /// Host: the same in vector registers.
  RELUME_HD_INLINE uint32_t enter_at_once(const BvhNode& node, float t_max, float* entries) const {
    using namespace bvh_detail;
    Floats4 first{0, 0, 0, 0};
    Floats4 last{t_max, t_max, t_max, t_max};
    for (int axis = 0; axis < 3; ++axis) {
      const uint32_t row = near_row_[axis];
      first = max(load(node.bounds[row]) * inverse_[axis] + near_[axis], first);
      last = min(load(node.bounds[row ^ 1u]) * inverse_[axis] + far_[axis], last);
    }
    store(entries, first);
    return bits_of(first <= last);
  }
#endif

 private:
  Vec3 inverse_;
  Vec3 near_;             ///< ray parameter of the plane through 0, less the margin
  Vec3 far_;              ///< the same, plus the margin
  uint32_t near_row_[3];  ///< rows of BvhNode::bounds that face the origin
};

}  // namespace relume
