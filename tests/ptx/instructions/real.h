// Floating point (PTX ISA 9.7.3) with .rn, the rounding to the nearest value, ties to even. Denormal numbers are kept.
// A result that is NaN is not_a_number().
#pragma once

#include <cmath>

#include "instructions/values.h"

namespace ptx {

template <typename T>
T add_rn(T a, T b) {
  return canonical(a + b);
}

template <typename T>
T sub_rn(T a, T b) {
  return canonical(a - b);
}

template <typename T>
T mul_rn(T a, T b) {
  return canonical(a * b);
}

template <typename T>
T div_rn(T a, T b) {
  return canonical(a / b);
}

template <typename T>
T rcp_rn(T a) {
  return canonical(T{1} / a);
}

template <typename T>
T sqrt_rn(T a) {
  return canonical(std::sqrt(a));
}

/// a · b + c with one rounding.
template <typename T>
T fma_rn(T a, T b, T c) {
  return canonical(std::fma(a, b, c));
}

/// Of integers: the smallest one wraps.
template <typename T>
T abs(T a) {
  if constexpr (std::is_floating_point_v<T>) {
    return canonical(std::fabs(a));
  } else {
    return a < 0 ? static_cast<T>(Bits<T>{0} - static_cast<Bits<T>>(a)) : a;
  }
}

/// The number if the other is NaN. −0 is less than +0.
template <typename T>
T min(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (is_nan(a)) return canonical(b);
    if (is_nan(b)) return a;
    if (a == b) return std::signbit(a) ? a : b;
  }
  return a < b ? a : b;
}

/// As min().
template <typename T>
T max(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (is_nan(a)) return canonical(b);
    if (is_nan(b)) return a;
    if (a == b) return std::signbit(a) ? b : a;
  }
  return a > b ? a : b;
}

/// The value of `b` with the sign of `a`. Only bits move, also of NaN.
template <typename T>
T copysign(T a, T b) {
  constexpr Bits<T> kSign = Bits<T>{1} << (kWidth<T> - 1);
  const auto bits = (std::bit_cast<Bits<T>>(a) & kSign) | (std::bit_cast<Bits<T>>(b) & ~kSign);
  return std::bit_cast<T>(static_cast<Bits<T>>(bits));
}

template <typename T>
bool testp_finite(T a) {
  return std::fabs(a) <= std::numeric_limits<T>::max();
}

template <typename T>
bool testp_infinite(T a) {
  return std::fabs(a) == std::numeric_limits<T>::infinity();
}

template <typename T>
bool testp_number(T a) {
  return !is_nan(a);
}

template <typename T>
bool testp_notanumber(T a) {
  return is_nan(a);
}

/// Zeros are normal.
template <typename T>
bool testp_normal(T a) {
  return a == 0 || (testp_finite(a) && std::fabs(a) >= std::numeric_limits<T>::min());
}

template <typename T>
bool testp_subnormal(T a) {
  return a != 0 && std::fabs(a) < std::numeric_limits<T>::min();
}

}  // namespace ptx
