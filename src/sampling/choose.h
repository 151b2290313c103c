// Chooses among few weights that are computed on the spot.
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace relume {

/// Index below `count` with probability weights[i] / sum; `sum` > 0 is that of the weights, which are not negative. `u`
/// in [0, 1) becomes what is left of it.
RELUME_HD inline uint32_t choose_by_weight(const float* weights, uint32_t count, float sum, float& u) {
  float rest = u * sum;
  uint32_t chosen = 0;
  uint32_t last = 0;
  for (; chosen < count; ++chosen) {
    if (!(weights[chosen] > 0.0f)) continue;
    last = chosen;
    if (rest < weights[chosen]) break;
    rest -= weights[chosen];
  }
  if (chosen == count) chosen = last;  // rounding ran past the end
  u = clamp(rest / weights[chosen], 0.0f, kOneMinusEpsilon);
  return chosen;
}

}  // namespace relume
