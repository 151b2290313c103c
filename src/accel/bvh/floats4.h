// Four floats in a vector register of the host.
#pragma once

#include <cstdint>
#include <cstring>

namespace relume::bvh_detail {

using Floats4 = float __attribute__((vector_size(16)));
using Ints4 = int32_t __attribute__((vector_size(16)));

[[gnu::always_inline]] inline Floats4 load(const float* from) {
  Floats4 result;
  std::memcpy(&result, from, sizeof result);
  return result;
}
/// Three floats, and 0.
[[gnu::always_inline]] inline Floats4 load_point(const float* from) { return Floats4{from[0], from[1], from[2], 0.0f}; }
[[gnu::always_inline]] inline void store(float* to, const Floats4& value) { std::memcpy(to, &value, sizeof value); }

// If a lane of the first argument is NaN, the second is returned.
[[gnu::always_inline]] inline Floats4 min(const Floats4& a, const Floats4& b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Floats4 max(const Floats4& a, const Floats4& b) { return a > b ? a : b; }

[[gnu::always_inline]] inline Floats4 or_bits(const Floats4& value, const Ints4& bits) {
  Ints4 result;
  std::memcpy(&result, &value, sizeof result);
  result |= bits;
  Floats4 floats;
  std::memcpy(&floats, &result, sizeof floats);
  return floats;
}

/// One bit per lane of the result of a comparison.
[[gnu::always_inline]] inline uint32_t bits_of(const Ints4& mask) {
#if defined(__SSE2__)
  Floats4 lanes;
  std::memcpy(&lanes, &mask, sizeof lanes);
  return static_cast<uint32_t>(__builtin_ia32_movmskps(lanes));
#else
  const Ints4 bits = mask & Ints4{1, 2, 4, 8};
  return static_cast<uint32_t>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}

}  // namespace relume::bvh_detail
