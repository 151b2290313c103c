// Where a row of pixels was in the previous frame, on the host.
#pragma once

#include "core/lane_views.h"
#include "core/vec.h"

namespace relume {

/// Where kLanes pixels that are side by side were in the previous frame, if side by side there too.
struct RowOrigin {
  int x = 0;         ///< column at or left of the first pixel's position; the other pixels follow to its right
  int y = 0;         ///< row at or above the positions
  Lanes fraction_x;  ///< distance of each position from its column, pixels, in [0, 1)
  Lanes fraction_y;  ///< distance of each position from the row, pixels, in [0, 1)
};

/// Finds where pixels (x … x + kLanes − 1, y) were, by their `motion` in pixels. Returns false if they were not side by
/// side.
RELUME_HD_INLINE bool find_row(const View<const Vec2>& motion, uint32_t width, uint32_t x, uint32_t y,
                               RowOrigin& origin) {
  constexpr float kFurthest = 1e6f;  // beyond it, a position might not fit an int
  Lanes way[2];
  get_pair(motion, y * width + x, way);
  Lanes column;
  for (uint32_t k = 0; k < kLanes; ++k) column.v[k] = static_cast<float>(x + k);
  const Lanes fx = column - way[0];
  const Lanes fy = static_cast<float>(y) - way[1];
  const Lanes x0 = floor_of(fx);
  const Lanes y0 = floor_of(fy);
  const Lanes from_first = column - static_cast<float>(x);
  const LaneMask together = (x0 <= x0[0] + from_first) & (x0[0] + from_first <= x0) & (y0 <= Lanes(y0[0])) &
                            (Lanes(y0[0]) <= y0) & (absolute(x0) <= Lanes(kFurthest)) &
                            (absolute(y0) <= Lanes(kFurthest));
  if (any_of(!together)) return false;
  origin = {static_cast<int>(x0[0]), static_cast<int>(y0[0]), fx - x0, fy - y0};
  return true;
}

}  // namespace relume
