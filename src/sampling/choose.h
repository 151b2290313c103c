// Chooses among things that are alike, or few whose weights are computed on the spot.
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace relume {

/// Whether `u` in [0, 1) falls to the first of two that share it, which has `share`; `u` becomes what is left of it.
RELUME_HD inline bool takes_share(float share, float& u) {
  const bool first = u < share;
  u = clamp(first ? u / share : (u - share) / (1.0f - share), 0.0f, kOneMinusEpsilon);
  return first;
}

/// Index below `count` > 0, all alike; `u` in [0, 1) becomes what is left of it.
RELUME_HD_INLINE uint32_t choose_evenly(uint32_t count, float& u) {
  const float scaled = u * static_cast<float>(count);
  const uint32_t chosen = relume::min(static_cast<uint32_t>(scaled), count - 1);  // rounding may reach the end
  u = clamp(scaled - static_cast<float>(chosen), 0.0f, kOneMinusEpsilon);
  return chosen;
}

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
