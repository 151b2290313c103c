// Logic and shifts (PTX ISA 9.7.8), and prmt. Names that C++ reserves end with an underscore.
#pragma once

#include "instructions/values.h"

namespace ptx {

template <typename T>
T and_(T a, T b) {
  return static_cast<T>(a & b);
}

template <typename T>
T or_(T a, T b) {
  return static_cast<T>(a | b);
}

template <typename T>
T xor_(T a, T b) {
  return static_cast<T>(a ^ b);
}

template <typename T>
T not_(T a) {
  if constexpr (std::is_same_v<T, bool>) {
    return !a;
  } else {
    return static_cast<T>(~a);
  }
}

/// 1 for 0, otherwise 0.
template <typename T>
T cnot(T a) {
  return a == 0 ? 1 : 0;
}

/// Shifts by the width or more give 0.
template <typename T>
T shl(T a, uint32_t n) {
  return n >= kWidth<T> ? T{0} : static_cast<T>(a << n);
}

/// Shifts by the width or more give the sign, or 0 for unsigned types.
template <typename T>
T shr(T a, uint32_t n) {
  if (n < kWidth<T>) return static_cast<T>(a >> n);
  return static_cast<T>(std::is_signed_v<T> && a < 0 ? -1 : 0);
}

/// The high half of b:a shifted to the left.
inline uint32_t funnel_left(uint32_t a, uint32_t b, uint32_t n) {
  return n == 32 ? a : static_cast<uint32_t>(((uint64_t{b} << 32 | a) << n) >> 32);
}

/// The low half of b:a shifted to the right.
inline uint32_t funnel_right(uint32_t a, uint32_t b, uint32_t n) {
  return static_cast<uint32_t>((uint64_t{b} << 32 | a) >> n);
}

inline uint32_t shf_l_wrap(uint32_t a, uint32_t b, uint32_t n) { return funnel_left(a, b, n & 31u); }
inline uint32_t shf_r_wrap(uint32_t a, uint32_t b, uint32_t n) { return funnel_right(a, b, n & 31u); }
inline uint32_t shf_l_clamp(uint32_t a, uint32_t b, uint32_t n) { return funnel_left(a, b, n < 32 ? n : 32); }
inline uint32_t shf_r_clamp(uint32_t a, uint32_t b, uint32_t n) { return funnel_right(a, b, n < 32 ? n : 32); }

/// Any function of three bits, for each bit: `table` holds its value for abc = 000 to 111.
inline uint32_t lop3(uint32_t a, uint32_t b, uint32_t c, uint32_t table) {
  uint32_t result = 0;
  for (uint32_t i = 0; i < 32; ++i) {
    const uint32_t index = ((a >> i) & 1u) << 2 | ((b >> i) & 1u) << 1 | ((c >> i) & 1u);
    result |= ((table >> index) & 1u) << i;
  }
  return result;
}

/// Picks four bytes of b:a. Each of the low nibbles of `selection` is the position of a byte; its highest bit replaces
/// the byte by copies of its sign.
inline uint32_t prmt(uint32_t a, uint32_t b, uint32_t selection) {
  const uint64_t bytes = uint64_t{b} << 32 | a;
  uint32_t result = 0;
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t nibble = (selection >> (4 * i)) & 0xfu;
    uint32_t byte = (bytes >> (8 * (nibble & 7u))) & 0xffu;
    if ((nibble & 8u) != 0) byte = (byte & 0x80u) != 0 ? 0xffu : 0u;
    result |= byte << (8 * i);
  }
  return result;
}

}  // namespace ptx
