// Elementary functions of floats and lanes. They use + − × ÷ and comparisons alone, so that every processor computes
// the same bits (compiled without contraction). Polynomials minimise the largest error.
#pragma once

#include "core/lanes.h"
#include "core/vec.h"

namespace relume {

/// Angle between the x axis and (x, y), y ≥ 0: [0, π] radians, 0 at the origin. Relative error below 3e-7.
template <typename T>
RELUME_HD_INLINE T upper_angle(const T& y, const T& x) {
  const T width = absolute(x);
  const T q = min(width, y) / max(max(width, y), T(1e-37f));
  const T z = q * q;
  T series = T(-0.0162830712f) + z * T(0.00290356775f);
  series = T(-0.0753368575f) + z * (T(0.0430394756f) + z * series);
  series = T(-0.142071351f) + z * (T(0.106546823f) + z * series);
  series = T(-0.33333094f) + z * (T(0.199930543f) + z * series);
  const T acute = q + q * (z * series);
  const T right = select(y > width, T(kPi / 2) - acute, acute);
  return select(x < T(0.0f), T(kPi) - right, right);
}

/// Sine and cosine of x in [0, π]. Absolute errors below 3e-7; that of the sine of acute angles is relative.
template <typename T>
RELUME_HD_INLINE void sine_and_cosine(const T& x, T& sine, T& cosine) {
  const MaskOf<T> obtuse = x > T(kPi / 2);
  const T acute = select(obtuse, T(kPi) - x, x);
  const T z = acute * acute;
  const T odd = T(-0.16666658f) + z * (T(0.00833305107f) + z * (T(-0.000198090756f) + z * T(2.60522553e-6f)));
  sine = acute + acute * (z * odd);
  const T even = T(0.0416666363f) + z * (T(-0.00138883614f) + z * (T(2.47601617e-5f) + z * T(-2.60514996e-7f)));
  const T c = T(1.0f) + z * (T(-0.5f) + z * even);
  cosine = select(obtuse, T(0.0f) - c, c);
}

}  // namespace relume
