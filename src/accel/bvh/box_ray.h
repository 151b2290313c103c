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
  RELUME_HD_INLINE uint32_t enter_one_by_one(const BvhNode& node, float t_max, float (&entries)[kBvhWidth]) const {
    float last[kBvhWidth];
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      entries[i] = 0.0f;
      last[i] = t_max;
    }
    clip_all(node, 0, entries, last);
    clip_all(node, 1, entries, last);
    clip_all(node, 2, entries, last);
    uint32_t entered = 0;
    for (uint32_t i = 0; i < kBvhWidth; ++i) entered |= (entries[i] <= last[i] ? 1u : 0u) << i;
    return entered;
  }

  /// Whether the ray enters child `i` before `t_max`.
  RELUME_HD_INLINE bool enters(const BvhNode& node, uint32_t i, float t_max) const {
    float first = 0.0f;
    float last = t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const uint32_t row = near_row_[axis];
      clip(axis, node.bounds[row][i], node.bounds[row ^ 1u][i], first, last);
    }
    return first <= last;
  }

#if !defined(__CUDACC__)
  /// Host: enter_one_by_one() in vector registers.
  RELUME_HD_INLINE uint32_t enter_at_once(const BvhNode& node, float t_max, float (&entries)[kBvhWidth]) const {
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
  /// Clips [first, last] to the planes of an axis that face the origin and that face away.
  RELUME_HD_INLINE void clip(int axis, float near_plane, float far_plane, float& first, float& last) const {
    first = max(near_plane * inverse_[axis] + near_[axis], first);
    last = min(far_plane * inverse_[axis] + far_[axis], last);
  }

  /// Clips the intervals [first[i], last[i]] to the planes of children i.
  RELUME_HD_INLINE void clip_all(const BvhNode& node, int axis, float (&first)[kBvhWidth],
                                 float (&last)[kBvhWidth]) const {
    static_assert(kBvhWidth == 4);
    const uint32_t r = near_row_[axis];
    const uint32_t s = r ^ 1u;
    // Constant column indices let device compilers combine the four loads of a row.
    const float near_planes[] = {node.bounds[r][0], node.bounds[r][1], node.bounds[r][2], node.bounds[r][3]};
    const float far_planes[] = {node.bounds[s][0], node.bounds[s][1], node.bounds[s][2], node.bounds[s][3]};
    for (uint32_t i = 0; i < kBvhWidth; ++i) clip(axis, near_planes[i], far_planes[i], first[i], last[i]);
  }

  Vec3 inverse_;
  Vec3 near_;             ///< ray parameter of the plane through 0, less the margin
  Vec3 far_;              ///< the same, plus the margin
  uint32_t near_row_[3];  ///< rows of BvhNode::bounds that face the origin
};

}  // namespace relume
