// Chooses among things that are alike, or few whose weights are computed on the spot.
#pragma once

#include <cstdint>

#include "core/hash.h"
#include "core/vec.h"

namespace relume {

/// A uniform number that decides more than one thing: each choice stretches what is left of it to [0, 1) again. That
/// keeps strata, but a float holds 24 bits, which a choice among a million lights uses up; choices among many therefore
/// append bits of a hash.
struct ReusableNumber {
  float u;        ///< in [0, 1)
  uint32_t bits;  ///< what the number belongs to, from which a hash makes more bits

  RELUME_HD_INLINE uint32_t next_bits() { return bits = hash(bits + 0x9e3779b9u); }
};

/// Whether `u` in [0, 1) falls to the first of two that share it, which has `share`; `u` becomes what is left of it.
RELUME_HD inline bool takes_share(float share, float& u) {
  const bool first = u < share;
  u = clamp(first ? u / share : (u - share) / (1.0f - share), 0.0f, kOneMinusEpsilon);
  return first;
}
RELUME_HD inline bool takes_share(float share, ReusableNumber& n) { return takes_share(share, n.u); }

/// Index below `count` > 0, all alike, which a float can tell apart; `u` in [0, 1) becomes what is left of it.
RELUME_HD_INLINE uint32_t choose_evenly(uint32_t count, float& u) {
  const float scaled = u * static_cast<float>(count);
  const uint32_t chosen = relume::min(static_cast<uint32_t>(scaled), count - 1);  // rounding may reach the end
  u = clamp(scaled - static_cast<float>(chosen), 0.0f, kOneMinusEpsilon);
  return chosen;
}

/// The same among as many as there may be.
RELUME_HD_INLINE uint32_t choose_evenly(uint32_t count, ReusableNumber& n) {
  // A fraction of 56 bits times the count: the digits before the point are the index, those after it the rest.
  const uint32_t more = n.next_bits();
  const uint64_t high = (uint64_t{static_cast<uint32_t>(n.u * 0x1p24f)} << 8) | (more >> 24);
  const uint64_t low = more << 8;
  const uint64_t product = high * count + ((low * count) >> 32);
  const uint32_t rest = static_cast<uint32_t>(product);
  // Near 0 a float has room for all 32 bits, by which the rarest alias is told from none.
  n.u = relume::min(to_unit_float(rest) + static_cast<float>(rest & 255u) * 0x1p-32f, kOneMinusEpsilon);
  return static_cast<uint32_t>(product >> 32);
}

/// Index below `count` with probability weights[i] / sum; `sum` > 0 is that of the weights, which are not negative. The
/// number becomes what is left of it.
RELUME_HD inline uint32_t choose_by_weight(const float* weights, uint32_t count, float sum, ReusableNumber& n) {
  float rest = n.u * sum;
  uint32_t chosen = 0;
  uint32_t last = 0;
  for (; chosen < count; ++chosen) {
    if (!(weights[chosen] > 0.0f)) continue;
    last = chosen;
    if (rest < weights[chosen]) break;
    rest -= weights[chosen];
  }
  if (chosen == count) chosen = last;  // rounding ran past the end
  // Where little of the sum was chosen little of the number is left: the last of its bits is made of new ones.
  const float grain = relume::min(sum * 0x1p-24f, weights[chosen]);
  n.u = clamp((rest + grain * to_unit_float(n.next_bits())) / weights[chosen], 0.0f, kOneMinusEpsilon);
  return chosen;
}

}  // namespace relume
