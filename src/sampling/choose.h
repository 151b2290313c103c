// Chooses among things that are alike, or few whose weights are computed on the spot.
#pragma once

#include <cstdint>

#include "core/hash.h"
#include "core/vec.h"

namespace relume {

/// A uniform number that decides more than one thing: each choice stretches what is left of it to [0, 1) again. That
/// keeps strata, but a float holds 24 bits, which a choice among a million lights uses up; below them each choice
/// therefore appends bits of a hash.
struct ReusableNumber {
  float u;        ///< in [0, 1)
  uint32_t bits;  ///< hash of what the number belongs to

  /// `part` of `width` in all, uniform in [0, width) but for the last of the 24 bits of `whole`, becomes the number.
  RELUME_HD_INLINE void stretch(float part, float width, float whole = 1.0f) {
    const float grain = relume::min(whole * 0x1p-24f, width);
    u = clamp((part + grain * to_unit_float(next_bits())) / width, 0.0f, kOneMinusEpsilon);
  }

  /// Appends bits to a number of 24: near 0, where they have room in a float, they decide about the rarest choices.
  RELUME_HD_INLINE void refine() { stretch(u, 1.0f); }

  RELUME_HD_INLINE uint32_t next_bits() { return bits = hash(bits + 0x9e3779b9u); }
};

/// Whether `u` in [0, 1) falls to the first of two that share it, which has `share`; `u` becomes what is left of it.
RELUME_HD inline bool takes_share(float share, float& u) {
  const bool first = u < share;
  u = clamp(first ? u / share : (u - share) / (1.0f - share), 0.0f, kOneMinusEpsilon);
  return first;
}
RELUME_HD inline bool takes_share(float share, ReusableNumber& n) {
  if (!(share > 0.0f) || share >= 1.0f) return share >= 1.0f;
  const bool first = n.u < share;
  n.stretch(first ? n.u : n.u - share, first ? share : 1.0f - share);
  return first;
}

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
  n.u = to_unit_float(static_cast<uint32_t>(product));
  n.refine();
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
  n.stretch(rest, weights[chosen], sum);
  return chosen;
}

}  // namespace relume
