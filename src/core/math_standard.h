// Computes the elementary functions of core/math.h with the C++ library. Only for tools/compare_math, which compares
// images of both versions. Values are rounded differently. The library and the processor decide whether denormal
// numbers become zero.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math_reduction.h"

namespace relume::math {

inline float sin(float x) { return std::sin(x); }
inline float cos(float x) { return std::cos(x); }
inline void sin_cos(float x, float& sine, float& cosine) {
  sine = std::sin(x);
  cosine = std::cos(x);
}
inline float exp(float x) { return std::exp(x); }
inline float exp2(float x) { return std::exp2(x); }
inline float log(float x) { return std::log(x); }
inline float log2(float x) { return std::log2(x); }
inline float atan2(float y, float x) { return std::atan2(y, x); }
/// x is clamped to [−1, 1].
inline float acos(float x) { return std::acos(std::clamp(x, -1.0f, 1.0f)); }

/// NaN if an argument is NaN or x is negative, as in core/math.h.
inline float pow(float x, float y) {
  if (detail::is_nan(x) || detail::is_nan(y) || (x < 0.0f && y != 0.0f)) return detail::not_a_number();
  return std::pow(x, y);
}

}  // namespace relume::math
