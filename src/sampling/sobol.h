// Owen-scrambled two-dimensional Sobol' points, computed by hashing.
#pragma once

#include "core/hash.h"
#include "core/vec.h"

namespace relume {

RELUME_HD_INLINE constexpr uint32_t reverse_bits(uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// Nested uniform (Owen) scramble of a number whose bits are stored in reverse: bit i of the result depends on bits
/// 0 … i of `x` only. [Laine11] with the constants of [Vegdahl21].
RELUME_HD_INLINE constexpr uint32_t owen_scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Second Sobol' dimension of point `index`, bits reversed. Its generator matrix is Pascal's triangle modulo 2, which
/// factors into five shift-and-xor steps.
RELUME_HD_INLINE constexpr uint32_t sobol_dimension_1_reversed(uint32_t index) {
  uint32_t x = index;
  x ^= (x & 0xaaaaaaaau) >> 1;
  x ^= (x & 0xccccccccu) >> 2;
  x ^= (x & 0xf0f0f0f0u) >> 4;
  x ^= (x & 0xff00ff00u) >> 8;
  x ^= (x & 0xffff0000u) >> 16;
  return x;
}

/// Distinct seeds for the shuffle and the two scrambles of one point set.
RELUME_HD_INLINE constexpr uint32_t derived_seed(uint32_t seed, uint32_t which) {
  return seed * (which == 1 ? 0x85ebca6bu : 0xc2b2ae35u) + which;
}

/// Point of a two-dimensional (0, 2)-sequence selected by `seed` (a well-mixed hash), shuffled and scrambled as in
/// [Burley20]. Every aligned run of 2^k indices is stratified over all elementary intervals of area 2^-k. Takes the
/// index with its bits reversed, which all dimensions of a pixel share.
RELUME_HD_INLINE Vec2 owen_sobol_2d(uint32_t reversed_index, uint32_t seed) {
  const uint32_t shuffled = reverse_bits(owen_scramble_reversed(reversed_index, seed));
  const uint32_t x = owen_scramble_reversed(shuffled, derived_seed(seed, 1));
  const uint32_t y = owen_scramble_reversed(sobol_dimension_1_reversed(shuffled), derived_seed(seed, 2));
  return {to_unit_float(reverse_bits(x)), to_unit_float(reverse_bits(y))};
}

/// Point of a scrambled van der Corput sequence selected by `seed`.
RELUME_HD_INLINE float owen_van_der_corput(uint32_t reversed_index, uint32_t seed) {
  const uint32_t shuffled = reverse_bits(owen_scramble_reversed(reversed_index, seed));
  return to_unit_float(reverse_bits(owen_scramble_reversed(shuffled, derived_seed(seed, 1))));
}

}  // namespace relume
