// Integer arithmetic (PTX ISA 9.7.1). Results wrap.
#pragma once

#include "instructions/values.h"

namespace ptx {

/// Wide enough for products of two values of type T.
template <typename T>
using Product =
    std::conditional_t<sizeof(T) == 8, std::conditional_t<std::is_signed_v<T>, __int128, unsigned __int128>,
                       std::conditional_t<sizeof(T) == 4, std::conditional_t<std::is_signed_v<T>, int64_t, uint64_t>,
                                          std::conditional_t<std::is_signed_v<T>, int32_t, uint32_t>>>;

template <typename T>
T add(T a, T b) {
  return static_cast<T>(static_cast<uint64_t>(a) + static_cast<uint64_t>(b));
}

template <typename T>
T sub(T a, T b) {
  return static_cast<T>(static_cast<uint64_t>(a) - static_cast<uint64_t>(b));
}

template <typename T>
T mul_lo(T a, T b) {
  return static_cast<T>(static_cast<uint64_t>(a) * static_cast<uint64_t>(b));
}

template <typename T>
Product<T> mul_wide(T a, T b) {
  return static_cast<Product<T>>(static_cast<Product<T>>(a) * static_cast<Product<T>>(b));
}

template <typename T>
T mul_hi(T a, T b) {
  return static_cast<T>(mul_wide(a, b) >> kWidth<T>);
}

template <typename T>
T mad_lo(T a, T b, T c) {
  return add(mul_lo(a, b), c);
}

template <typename T>
T mad_hi(T a, T b, T c) {
  return add(mul_hi(a, b), c);
}

template <typename T>
Product<T> mad_wide(T a, T b, Product<T> c) {
  return add(mul_wide(a, b), c);
}

template <typename T>
T neg(T a) {
  if constexpr (std::is_floating_point_v<T>) {
    return canonical(-a);  // also changes the sign of zeros
  } else {
    return sub(T{0}, a);
  }
}

/// The ISA leaves the quotient by zero open: all bits set, as NVIDIA's devices return. The smallest integer by −1
/// wraps.
template <typename T>
T div(T a, T b) {
  if (b == 0) return static_cast<T>(~T{0});
  if (std::is_signed_v<T> && b == static_cast<T>(-1)) return neg(a);
  return static_cast<T>(a / b);
}

/// Has the sign of `a`. The ISA leaves the remainder by zero open: `a`.
template <typename T>
T rem(T a, T b) {
  if (b == 0) return a;
  if (std::is_signed_v<T> && b == static_cast<T>(-1)) return 0;
  return static_cast<T>(a % b);
}

/// c + |a − b|.
template <typename T>
T sad(T a, T b, T c) {
  return add(c, a < b ? sub(b, a) : sub(a, b));
}

/// Number of bits that are set.
template <typename T>
uint32_t popc(T a) {
  return static_cast<uint32_t>(std::popcount(a));
}

/// Number of zeros before the highest bit that is set.
template <typename T>
uint32_t clz(T a) {
  return static_cast<uint32_t>(std::countl_zero(a));
}

/// Position of the highest bit that differs from the sign, or all bits set if there is none.
template <typename T>
uint32_t bfind(T a) {
  const auto bits = static_cast<Bits<T>>(std::is_signed_v<T> && a < 0 ? ~a : a);
  return bits == 0 ? 0xffffffffu : kWidth<T> - 1 - clz(bits);
}

/// The shift to the left that moves that bit to the highest position.
template <typename T>
uint32_t bfind_shiftamt(T a) {
  const uint32_t position = bfind(a);
  return position == 0xffffffffu ? position : kWidth<T> - 1 - position;
}

/// The bits in reverse order.
template <typename T>
T brev(T a) {
  T low = static_cast<T>(~T{0});  // the lower half of each pair that is swapped
  for (uint32_t n = kWidth<T> / 2; n > 0; n /= 2) {
    low = static_cast<T>(low ^ (low << n));
    a = static_cast<T>(((a >> n) & low) | ((a & low) << n));
  }
  return a;
}

/// Mask of the low `length` bits.
template <typename T>
Bits<T> low_bits(uint32_t length) {
  return length >= kWidth<T> ? static_cast<Bits<T>>(~Bits<T>{0}) : static_cast<Bits<T>>((Bits<T>{1} << length) - 1);
}

/// `length` bits of `a` from `position` on. Signed types repeat the highest of them; positions beyond the width have
/// the sign, or 0 for unsigned types. Only the low 8 bits of `position` and `length` count.
template <typename T>
T bfe(T a, uint32_t position, uint32_t length) {
  position &= 0xffu;
  length &= 0xffu;
  if (position >= kWidth<T> && !std::is_signed_v<T>) return 0;
  const T field = static_cast<T>(a >> (position < kWidth<T> ? position : kWidth<T> - 1));
  const Bits<T> mask = low_bits<T>(length);
  const bool negative = std::is_signed_v<T> && length > 0 && length < kWidth<T> && ((field >> (length - 1)) & 1) != 0;
  return static_cast<T>((static_cast<Bits<T>>(field) & mask) | (negative ? ~mask : 0));
}

/// `b` with `length` bits replaced by the low ones of `a`, from `position` on. Only the low 8 bits of both count.
template <typename T>
T bfi(T a, T b, uint32_t position, uint32_t length) {
  position &= 0xffu;
  if (position >= kWidth<T>) return b;
  const auto mask = static_cast<Bits<T>>(low_bits<T>(length & 0xffu) << position);
  return static_cast<T>((b & ~mask) | (static_cast<T>(a << position) & mask));
}

}  // namespace ptx
