// Comparison and selection (PTX ISA 9.7.6).
#pragma once

#include "instructions/values.h"

namespace ptx {

// False if an operand is NaN.

template <typename T>
bool setp_eq(T a, T b) {
  return a == b;
}

template <typename T>
bool setp_ne(T a, T b) {
  return a < b || a > b;
}

template <typename T>
bool setp_lt(T a, T b) {
  return a < b;
}

template <typename T>
bool setp_le(T a, T b) {
  return a <= b;
}

template <typename T>
bool setp_gt(T a, T b) {
  return a > b;
}

template <typename T>
bool setp_ge(T a, T b) {
  return a >= b;
}

// True if an operand is NaN.

template <typename T>
bool setp_equ(T a, T b) {
  return !setp_ne(a, b);
}

template <typename T>
bool setp_neu(T a, T b) {
  return !setp_eq(a, b);
}

template <typename T>
bool setp_ltu(T a, T b) {
  return !setp_ge(a, b);
}

template <typename T>
bool setp_leu(T a, T b) {
  return !setp_gt(a, b);
}

template <typename T>
bool setp_gtu(T a, T b) {
  return !setp_le(a, b);
}

template <typename T>
bool setp_geu(T a, T b) {
  return !setp_lt(a, b);
}

/// Whether both operands are numbers.
template <typename T>
bool setp_num(T a, T b) {
  return !is_nan(a) && !is_nan(b);
}

/// Whether an operand is NaN.
template <typename T>
bool setp_nan(T a, T b) {
  return is_nan(a) || is_nan(b);
}

// Other names for unsigned types.

template <typename T>
bool setp_lo(T a, T b) {
  return a < b;
}

template <typename T>
bool setp_ls(T a, T b) {
  return a <= b;
}

template <typename T>
bool setp_hi(T a, T b) {
  return a > b;
}

template <typename T>
bool setp_hs(T a, T b) {
  return a >= b;
}

/// All bits set, or 1.0 for floats, where the comparison is true; otherwise 0.
template <typename D, auto compare, typename T>
D set_(T a, T b) {
  if (!compare(a, b)) return 0;
  return std::is_floating_point_v<D> ? D{1} : static_cast<D>(-1);
}

template <typename T>
T selp(T a, T b, bool c) {
  return c ? a : b;
}

}  // namespace ptx
