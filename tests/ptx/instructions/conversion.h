// cvt and cvta (PTX ISA 9.7.9).
#pragma once

#include <cmath>

#include "instructions/values.h"

namespace ptx {

// ---- Without rounding

/// Between integers: the low bits, or the value extended. From f32 to f64: exact.
template <typename D, typename S>
D cvt(S a) {
  if constexpr (std::is_floating_point_v<D>) {
    return canonical(static_cast<D>(a));
  } else {
    return static_cast<D>(a);
  }
}

// ---- To floating point: .rn nearest, ties to even; .rz towards zero; .rm towards −∞; .rp towards +∞

/// −1, 0 or 1 if the rounded value is less than, equal to or greater than the exact one.
template <typename D, typename S>
int rounding_error(D rounded, S exact) {
  if constexpr (std::is_integral_v<S>) {
    const auto whole = static_cast<__int128>(rounded);  // at most 2^64
    return whole < exact ? -1 : whole > exact ? 1 : 0;
  } else {
    const auto wide = static_cast<S>(rounded);
    return wide < exact ? -1 : wide > exact ? 1 : 0;
  }
}

template <typename D>
D next_below(D a) {
  return std::nextafter(a, -std::numeric_limits<D>::infinity());
}

template <typename D>
D next_above(D a) {
  return std::nextafter(a, std::numeric_limits<D>::infinity());
}

template <typename D, typename S>
D cvt_rn(S a) {
  return canonical(static_cast<D>(a));
}

template <typename D, typename S>
D cvt_rm(S a) {
  const D nearest = cvt_rn<D>(a);
  return rounding_error(nearest, a) > 0 ? next_below(nearest) : nearest;
}

template <typename D, typename S>
D cvt_rp(S a) {
  const D nearest = cvt_rn<D>(a);
  if (rounding_error(nearest, a) >= 0) return nearest;
  return std::copysign(next_above(nearest), nearest);  // −0 stays negative
}

template <typename D, typename S>
D cvt_rz(S a) {
  return a < 0 ? cvt_rp<D>(a) : cvt_rm<D>(a);
}

// ---- To integers, or to integral values of the same floating-point type. Integers saturate.

/// The ISA's result for NaN: 0, or only the highest bit set where one of the types has 64 bits.
template <typename D, typename S>
D integer_of_nan() {
  if (sizeof(D) < 8 && sizeof(S) < 8) return 0;
  return static_cast<D>(Bits<D>{1} << (kWidth<D> - 1));
}

/// The integer of an integral value.
template <typename D, typename S>
D saturated(S whole) {
  if constexpr (std::is_floating_point_v<D>) {
    return canonical(whole);
  } else {
    const S end = std::ldexp(S{1}, std::numeric_limits<D>::digits);
    if (is_nan(whole)) return integer_of_nan<D, S>();
    if (whole >= end) return std::numeric_limits<D>::max();
    if (whole < (std::is_signed_v<D> ? -end : S{0})) return std::numeric_limits<D>::min();
    return static_cast<D>(whole);
  }
}

/// Nearest, ties to even.
template <typename D, typename S>
D cvt_rni(S a) {
  return saturated<D>(std::nearbyint(a));
}

template <typename D, typename S>
D cvt_rzi(S a) {
  return saturated<D>(std::trunc(a));
}

template <typename D, typename S>
D cvt_rmi(S a) {
  return saturated<D>(std::floor(a));
}

template <typename D, typename S>
D cvt_rpi(S a) {
  return saturated<D>(std::ceil(a));
}

/// Between the addresses of a state space and generic ones: all are addresses of the processor.
inline uint64_t cvta(uint64_t address) { return address; }

}  // namespace ptx
