// Clips triangles for spatial splits ([Stich09]).
#pragma once

#include <utility>

#include "accel/bvh/floats4.h"
#include "core/vec.h"

namespace relume {

/// A box in registers; the fourth lanes are unused.
struct ClipBox {
  bvh_detail::Floats4 low{kInfinity, kInfinity, kInfinity, kInfinity};
  bvh_detail::Floats4 high = -low;

  /// Adds a point if `condition` holds. Branch-free, because the condition is unpredictable.
  void add_if(bool condition, const bvh_detail::Floats4& point) {
    const int32_t mask = condition ? 0 : -1;
    const bvh_detail::Floats4 p =
        bvh_detail::or_bits(point, bvh_detail::Ints4{mask, mask, mask, mask});  // NaN changes nothing
    low = bvh_detail::min(p, low);
    high = bvh_detail::max(p, high);
  }
};

/// Bounds of the parts of a triangle on both sides of the plane where coordinate `axis` is `position`: first below,
/// then above. `within`: bounds of the triangle's part so far. The error is at most 9 · 2⁻²⁴ times the largest
/// coordinate, which the margin of boxes includes.
inline std::pair<ClipBox, ClipBox> clip_triangle(const float* const corners[3], int axis, float position,
                                                 const ClipBox& within) {
  using bvh_detail::Floats4;
  ClipBox below;
  ClipBox above;
  for (int i = 0; i < 3; ++i) {
    const float* const next = corners[(i + 1) % 3];
    const Floats4 a = bvh_detail::load_point(corners[i]);
    const float to_a = corners[i][axis] - position;
    const float to_b = next[axis] - position;
    const Floats4 crossing = a + (bvh_detail::load_point(next) - a) * (to_a / (to_a - to_b));
    const bool crosses = (to_a < 0.0f) != (to_b < 0.0f);
    below.add_if(to_a <= 0.0f, a);
    above.add_if(to_a >= 0.0f, a);
    below.add_if(crosses, crossing);
    above.add_if(crosses, crossing);
  }
  const auto clipped = [&](const ClipBox& part, const ClipBox& side) {
    // A part may be empty by rounding only; then a sliver at the plane holds it.
    const ClipBox& source = part.low[0] > part.high[0] ? side : part;
    ClipBox result;
    result.low = bvh_detail::max(source.low, side.low);
    result.high = bvh_detail::max(result.low, bvh_detail::min(source.high, side.high));
    return result;
  };
  ClipBox side_below = within;
  ClipBox side_above = within;
  side_below.high[axis] = max(within.low[axis], min(within.high[axis], position));
  side_above.low[axis] = min(within.high[axis], max(within.low[axis], position));
  return {clipped(below, side_below), clipped(above, side_above)};
}

}  // namespace relume
