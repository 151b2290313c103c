// Elementary functions of floats that give the same bits on every processor. They use only + − × ÷ √, comparisons and
// integers, without fused multiply-adds (-ffp-contract=off); pow() and exp2() compute in doubles. Denormal arguments
// count as zero and denormal results are zero, whether or not the processor flushes them. NaN gives NaN. Errors are in
// units in the last place (ulp) of the exact value. The build option RELUME_STANDARD_MATH replaces the elementary
// functions, without these guarantees.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/hd.h"
#include "core/math_reduction.h"
#include "relume/math.h"

#if defined(RELUME_STANDARD_MATH)
#include "core/math_standard.h"
#else

namespace relume::math {

/// Sine and cosine of x radians, within 1.5 ulp; NaN for infinities. The sine of −0 is +0.
RELUME_HD inline void sin_cos(float x, float& sine, float& cosine) {
  using namespace detail;
  if ((bits_of(x) & kMagnitude) >= kInfinityBits) {
    sine = cosine = not_a_number();
    return;
  }
  const QuarterTurn turn = reduce(flush(x));
  const float s = sin_near_zero(turn.rest);
  const float c = cos_near_zero(turn.rest);
  const bool swapped = (turn.quarters & 1u) != 0;
  sine = swapped ? c : s;
  cosine = swapped ? s : c;
  if ((turn.quarters & 2u) != 0) sine = -sine;
  if (((turn.quarters + 1u) & 2u) != 0) cosine = -cosine;
}

/// As sin_cos().
RELUME_HD inline float sin(float x) {
  float sine, cosine;
  sin_cos(x, sine, cosine);
  return sine;
}

/// As sin_cos().
RELUME_HD inline float cos(float x) {
  float sine, cosine;
  sin_cos(x, sine, cosine);
  return cosine;
}

/// e^x within 1.05 ulp.
RELUME_HD inline float exp(float x) {
  using namespace detail;
  if (is_nan(x)) return not_a_number();
  x = flush(x);
  if (x > 88.7228394f) return kInfinity;  // beyond the largest float
  if (x < -87.3365402f) return 0.0f;      // denormal
  const float k = nearest_integer(x * 0x1.715476p0f);
  const float r = (x - k * 0x1.62e4p-1f) - k * 0x1.7f7d1cp-20f;  // k · ln 2 in two parts; the first product is exact
  const float series = 0.5f + r * (0x1.5554dcp-3f + r * (0x1.55556ap-5f + r * (0x1.120c86p-7f + r * 0x1.6cad1cp-10f)));
  const auto n = static_cast<int32_t>(k);
  return (1.0f + (r + r * (r * series))) * power_of_two(n >> 1) * power_of_two(n - (n >> 1));
}

/// Natural logarithm within 1 ulp; −infinity for zeros, NaN for negative numbers.
RELUME_HD inline float log(float x) {
  using namespace detail;
  if (!is_positive_normal(x)) return log_of_others(x);
  const Scaled a = scaled(x);
  const LogParts parts = log_parts(a.mantissa);
  return a.exponent * 0x1.62e4p-1f - ((parts.half_square - (parts.tail + a.exponent * 0x1.7f7d1cp-20f)) - parts.f);
}

/// Logarithm to the base 2, within 1 ulp and exact for powers of 2; special values as for log().
RELUME_HD inline float log2(float x) {
  using namespace detail;
  if (!is_positive_normal(x)) return log_of_others(x);
  const Scaled a = scaled(x);
  const LogParts parts = log_parts(a.mantissa);
  // ln of the mantissa in two parts, times 1 / ln 2 in two parts.
  const float high = upper_half(parts.f - parts.half_square);
  const float low = ((parts.f - high) - parts.half_square) + parts.tail;
  return (low + high) * -0x1.7135a8p-13f + low * 0x1.716p0f + high * 0x1.716p0f + a.exponent;
}

/// x^y within 0.51 ulp, computed in double precision. NaN if either argument is NaN, unlike std::pow(). Otherwise 1 if
/// y is 0 or x is 1, and NaN for other negative x.
RELUME_HD inline float pow(float x, float y) {
  using namespace detail;
  if (is_nan(x) || is_nan(y)) return not_a_number();
  y = flush(y);
  if (y == 0.0f || x == 1.0f) return 1.0f;
  const bool grows = y > 0.0f;
  if (flush(x) == 0.0f) return grows ? 0.0f : kInfinity;
  if (x < 0.0f) return not_a_number();
  if (x == kInfinity) return grows ? kInfinity : 0.0f;
  if (!is_positive_normal(magnitude(y))) return (x > 1.0f) == grows ? kInfinity : 0.0f;
  const Scaled a = scaled(x);
  return exp2_of(static_cast<double>(y) * (static_cast<double>(a.exponent) + log2_near_one(a.mantissa)));
}

/// 2^x within 0.51 ulp; infinity for x ≥ 128, 0 for x < −126.
RELUME_HD inline float exp2(float x) { return detail::is_nan(x) ? detail::not_a_number() : detail::exp2_of(x); }

/// Angle of (x, y) from the x axis in [−π, π] radians, within 1.5 ulp. Zeros and infinities as std::atan2.
RELUME_HD inline float atan2(float y, float x) {
  using namespace detail;
  if (is_nan(x) || is_nan(y)) return not_a_number();
  const float width = flush(magnitude(x));
  const float height = flush(magnitude(y));
  const bool steep = height > width;
  const Fraction acute = scaled_fraction(steep ? width : height, steep ? height : width);
  // Above tan(π/8): atan(q) = π/4 + atan((q − 1) / (q + 1)).
  const bool diagonal = acute.numerator > 0x1.a8279ap-2f * acute.denominator;
  const float numerator = diagonal ? acute.numerator - acute.denominator : acute.numerator;
  const float denominator = diagonal ? acute.numerator + acute.denominator : acute.denominator;
  const float q = is_normal_fraction(acute) ? numerator / denominator : 0.0f;
  float low = 0.0f;  // part of q that the rounding of numerator and denominator lost
  if (diagonal) {
    const float numerator_error = acute.numerator - (numerator + acute.denominator);
    const float denominator_error = acute.numerator - (denominator - acute.denominator);
    low = (numerator_error - q * denominator_error) / denominator;
  }
  // The angle is a multiple of π/4, plus or minus atan(q).
  uint32_t eighths = diagonal ? 1 : 0;
  float sign = 1.0f;
  if (steep) {
    eighths = 2 - eighths;
    sign = -sign;
  }
  if (is_negative(x)) {
    eighths = 4 - eighths;
    sign = -sign;
  }
  const TwoFloats base = eighth_turns(eighths);
  const float angle = base.high + (sign * q + (sign * (atan_tail(q) + low) + base.low));
  return is_negative(y) ? -angle : angle;
}

/// Angle in [0, π] radians, within 1 ulp. x is clamped to [−1, 1].
RELUME_HD inline float acos(float x) {
  using namespace detail;
  if (is_nan(x)) return not_a_number();
  const float size = magnitude(x);
  if (size >= 1.0f) return is_negative(x) ? kPiHigh : 0.0f;
  if (size <= 0.5f) {
    const float tail = asin_tail(x * x);
    return 0.5f * kPiHigh - (x - (0.5f * kPiLow - x * tail));
  }
  // acos(x) = 2 asin √((1 − x) / 2), the root in two parts.
  const float square = 0.5f * (1.0f - size);
  const float root = std::sqrt(square);
  const float tail = root * asin_tail(square);
  if (is_negative(x)) return kPiHigh - 2.0f * (root + (tail - 0.5f * kPiLow));
  const float high = upper_half(root);
  const float low = (square - high * high) / (root + high);
  return 2.0f * (high + (tail + low));
}

}  // namespace relume::math

#endif

namespace relume::math {

/// Point of the unit circle at `angle` radians from the x axis.
RELUME_HD inline Vec2 unit_vector(float angle) {
  Vec2 v;
  sin_cos(angle, v.y, v.x);
  return v;
}

/// Nearest integer, halves away from zero. Saturates, for infinities too. NaN gives 0.
RELUME_HD inline int32_t round_to_int(float x) {
  if (!(x > -2147483648.0f)) return detail::is_nan(x) ? 0 : INT32_MIN;
  if (x >= 2147483648.0f) return INT32_MAX;
  const auto whole = static_cast<int32_t>(x);
  const float rest = x - static_cast<float>(whole);  // exact: from 2^23 on, floats are whole
  return whole + (rest >= 0.5f ? 1 : 0) - (rest <= -0.5f ? 1 : 0);
}

/// x rounded towards zero and clamped to the range of uint32_t; 0 for NaN.
RELUME_HD inline uint32_t truncate_to_uint(float x) {
  if (!(x > 0.0f)) return 0;
  return x < 4294967296.0f ? static_cast<uint32_t>(x) : UINT32_MAX;
}

/// x rounded towards zero and clamped to the range of int64_t; the minimum for NaN.
RELUME_HD inline int64_t truncate_to_int64(double x) {
  if (!(x > -9223372036854775808.0)) return INT64_MIN;
  return x < 9223372036854775808.0 ? static_cast<int64_t>(x) : INT64_MAX;
}

}  // namespace relume::math
