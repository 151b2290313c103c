// Integer hashes. Every random decision in relume is a hash of the numbers that identify it.
#pragma once

#include <bit>
#include <cstdint>

#include "core/hd.h"

namespace relume {

/// Bijective 32-bit mixer with low bias (constants found by the search of [Wellons18], "lowbias32").
RELUME_HD_INLINE constexpr uint32_t hash(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

RELUME_HD_INLINE constexpr uint32_t hash(uint32_t a, uint32_t b) { return hash(a ^ hash(b + 0x9e3779b9u)); }
RELUME_HD_INLINE constexpr uint32_t hash(uint32_t a, uint32_t b, uint32_t c) { return hash(hash(a, b), c); }
RELUME_HD_INLINE constexpr uint32_t hash(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  return hash(hash(a, b, c), d);
}

/// Uniform in [0, 1) from the upper 24 bits. Converts through a signed integer, the only conversion of vector units.
RELUME_HD_INLINE constexpr float to_unit_float(uint32_t x) {
  return static_cast<float>(static_cast<int32_t>(x >> 8)) * 0x1p-24f;
}

RELUME_HD_INLINE uint32_t float_bits(float x) { return std::bit_cast<uint32_t>(x); }
RELUME_HD_INLINE float bits_float(uint32_t x) { return std::bit_cast<float>(x); }

}  // namespace relume
