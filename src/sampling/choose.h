// Choices among equally likely items, or among few items with weights computed on the fly.
#pragma once

#include <cstdint>

#include "core/hash.h"
#include "core/vec.h"

namespace relume {

/// A uniform number that serves several choices. Each choice rescales the remainder to [0, 1), which preserves strata.
/// A float has only 24 bits, which one choice among a million lights exhausts. Choices among many items therefore
/// append hash bits.
struct ReusableNumber {
  float u;        ///< in [0, 1)
  uint32_t bits;  ///< identity of the number, hashed to generate more bits

  RELUME_HD_INLINE uint32_t next_bits() { return bits = hash(bits + 0x9e3779b9u); }
};

/// Whether `u` in [0, 1) falls into the first of two shares, of size `share`. `u` becomes its remainder within the
/// chosen share.
RELUME_HD inline bool takes_share(float share, float& u) {
  const bool first = u < share;
  u = clamp(first ? u / share : (u - share) / (1.0f - share), 0.0f, kOneMinusEpsilon);
  return first;
}
RELUME_HD inline bool takes_share(float share, ReusableNumber& n) { return takes_share(share, n.u); }

/// Uniform index below `count` > 0, which must be small enough for a float. `u` in [0, 1) becomes its remainder.
RELUME_HD_INLINE uint32_t choose_evenly(uint32_t count, float& u) {
  const float scaled = u * static_cast<float>(count);
  const uint32_t chosen = relume::min(static_cast<uint32_t>(scaled), count - 1);  // rounding may reach the end
  u = clamp(scaled - static_cast<float>(chosen), 0.0f, kOneMinusEpsilon);
  return chosen;
}

/// The same for any count.
RELUME_HD_INLINE uint32_t choose_evenly(uint32_t count, ReusableNumber& n) {
  // Multiplies a fraction of 56 bits by the count: the integer part is the index, the fraction the remainder.
  const uint32_t more = n.next_bits();
  const uint64_t high = (uint64_t{static_cast<uint32_t>(n.u * 0x1p24f)} << 8) | (more >> 24);
  const uint64_t low = more << 8;
  const uint64_t product = high * count + ((low * count) >> 32);
  const uint32_t rest = static_cast<uint32_t>(product);
  // Near 0 a float resolves all 32 bits, which separates the rarest alias from probability zero.
  n.u = relume::min(to_unit_float(rest) + static_cast<float>(rest & 255u) * 0x1p-32f, kOneMinusEpsilon);
  return static_cast<uint32_t>(product >> 32);
}

/// Index below `count` with probability weights[i] / sum. `sum` > 0 is the sum of the weights, which are not negative.
/// The number becomes its remainder.
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
  // The remainder of a small share has few bits; new ones replace the lowest.
  const float grain = relume::min(sum * 0x1p-24f, weights[chosen]);
  n.u = clamp((rest + grain * to_unit_float(n.next_bits())) / weights[chosen], 0.0f, kOneMinusEpsilon);
  return chosen;
}

}  // namespace relume
