// Parts of the elementary functions: argument reductions, and polynomials that minimise the largest relative error.
#pragma once

#include <cstdint>

#include "core/hd.h"
#include "relume/math.h"

namespace relume::math::detail {

inline constexpr uint32_t kMagnitude = 0x7fffffffu;
inline constexpr uint32_t kInfinityBits = 0x7f800000u;
inline constexpr uint32_t kSmallestNormalBits = 0x00800000u;
inline constexpr float kPiHigh = 0x1.921fb6p1f;  ///< π is kPiHigh + kPiLow
inline constexpr float kPiLow = -0x1.777a5cp-24f;

RELUME_HD inline uint32_t bits_of(float x) { return __builtin_bit_cast(uint32_t, x); }
RELUME_HD inline float float_of(uint32_t bits) { return __builtin_bit_cast(float, bits); }

/// NaN with the bits that NVIDIA GPUs produce.
RELUME_HD inline float not_a_number() { return float_of(0x7fffffffu); }

RELUME_HD inline bool is_nan(float x) { return (bits_of(x) & kMagnitude) > kInfinityBits; }
RELUME_HD inline bool is_negative(float x) { return bits_of(x) > kMagnitude; }
RELUME_HD inline bool is_positive_normal(float x) {
  return bits_of(x) >= kSmallestNormalBits && bits_of(x) < kInfinityBits;
}
RELUME_HD inline float magnitude(float x) { return float_of(bits_of(x) & kMagnitude); }

/// Zero of the same sign for denormal numbers.
RELUME_HD inline float flush(float x) {
  return (bits_of(x) & kMagnitude) < kSmallestNormalBits ? float_of(bits_of(x) & ~kMagnitude) : x;
}

/// The first 12 of the 24 bits of the mantissa: products of two halves are exact.
RELUME_HD inline float upper_half(float x) { return float_of(bits_of(x) & 0xfffff000u); }

/// Nearest integer, halves to even, for |x| < 2^22.
RELUME_HD inline float nearest_integer(float x) { return (x + 0x1.8p23f) - 0x1.8p23f; }

/// 2^n for n in [−126, 127].
RELUME_HD inline float power_of_two(int32_t n) { return float_of(static_cast<uint32_t>(n + 127) << 23); }

struct TwoFloats {
  float high;
  float low;
};

// ---- Sine and cosine

/// An angle of rest + quarters · π/2, |rest| ≤ π/4.
struct QuarterTurn {
  float rest;
  uint32_t quarters;  ///< modulo 4
};

/// For |x| ≤ 1608: π/2 in parts of 13 bits, whose products with the number of quarters are exact.
RELUME_HD inline QuarterTurn reduce_small(float x) {
  const float k = nearest_integer(x * 0x1.45f306p-1f);
  const float first = x - k * 0x1.922p0f;
  const float second = k * -0x1.2afp-18f;
  const float high = first - second;
  const float low = (((first - high) - second) - k * 0x1.0b4p-34f) - k * 0x1.84698ap-48f;
  return {high + low, static_cast<uint32_t>(static_cast<int32_t>(k))};
}

/// Bits 32 · word to 32 · word + 31 of 2/π after the binary point.
RELUME_HD inline uint32_t two_over_pi(int word) {
  switch (word) {
    case 0: return 0xa2f9836eu;
    case 1: return 0x4e441529u;
    case 2: return 0xfc2757d1u;
    case 3: return 0xf534ddc0u;
    case 4: return 0xdb629599u;
    case 5: return 0x3c439041u;
    default: return 0;
  }
}

/// |x| · 2/π modulo 4 for |x| ≥ 2^10, with 62 bits after the binary point. Skips bits of 2/π that give multiples of 4
/// ([Payne83]).
RELUME_HD inline uint64_t quarters_of_large(float x) {
  const uint32_t bits = bits_of(x) & kMagnitude;
  const int exponent = static_cast<int>(bits >> 23) - 150;  // |x| = mantissa · 2^exponent
  const uint64_t mantissa = (bits & 0x007fffffu) | 0x00800000u;
  const int skipped = exponent > 2 ? exponent - 2 : 0;
  uint64_t digit[4];
  for (int i = 0; i < 4; ++i) {
    const int word = (skipped >> 5) + i;
    const uint64_t pair = (static_cast<uint64_t>(two_over_pi(word)) << 32) | two_over_pi(word + 1);
    digit[i] = (pair << (skipped & 31)) >> 32;
  }
  const uint64_t p3 = mantissa * digit[3];
  const uint64_t p2 = mantissa * digit[2] + (p3 >> 32);
  const uint64_t p1 = mantissa * digit[1] + (p2 >> 32);
  const uint64_t p0 = mantissa * digit[0] + (p1 >> 32);    // weight 2^-32
  const uint64_t below = (p1 << 32) | (p2 & 0xffffffffu);  // weight 2^-96
  const int shift = exponent - skipped;                    // in [−13, 2]
  return (p0 << (30 + shift)) | (below >> (34 - shift));
}

/// fraction · 2^-64 · π/2, of the first 48 bits of the fraction.
RELUME_HD inline float radians_of_quarter(uint64_t fraction) {
  if (fraction == 0) return 0.0f;
  int zeros = 0;
  while ((fraction >> 63) == 0) {
    fraction <<= 1;
    ++zeros;
  }
  const float unit = power_of_two(-24 - zeros);
  const float first = static_cast<float>(static_cast<int32_t>(fraction >> 40)) * unit;
  const float second = static_cast<float>(static_cast<int32_t>((fraction >> 16) & 0xffffffu)) * (unit * 0x1p-24f);
  const float high = upper_half(first);
  return high * 0x1.922p0f + (high * -0x1.2aeef4p-18f + ((first - high) + second) * 0x1.921fb6p0f);
}

RELUME_HD inline QuarterTurn reduce_large(float x) {
  const uint64_t turn = quarters_of_large(x);
  const auto fraction = static_cast<int64_t>(turn << 2);  // of a quarter, in [−½, ½)
  const uint32_t quarters = static_cast<uint32_t>(turn >> 62) + (fraction < 0 ? 1u : 0u);
  const auto size = static_cast<uint64_t>(fraction);
  const float rest = fraction < 0 ? -radians_of_quarter(0 - size) : radians_of_quarter(size);
  return is_negative(x) ? QuarterTurn{-rest, 0u - quarters} : QuarterTurn{rest, quarters};
}

RELUME_HD inline QuarterTurn reduce(float x) { return magnitude(x) <= 1608.0f ? reduce_small(x) : reduce_large(x); }

/// sin(x) for |x| ≤ π/4.
RELUME_HD inline float sin_near_zero(float x) {
  const float z = x * x;
  const float odd = -0x1.555556p-3f + z * (0x1.111196p-7f + z * (-0x1.a08016p-13f + z * 0x1.867bcep-19f));
  return x + x * (z * odd);
}

/// cos(x) for |x| ≤ π/4.
RELUME_HD inline float cos_near_zero(float x) {
  const float z = x * x;
  const float half = 0.5f * z;
  const float rounded = 1.0f - half;
  const float even = 0x1.555554p-5f + z * (-0x1.6c128ep-10f + z * 0x1.9bbd7ep-16f);
  return rounded + (((1.0f - rounded) - half) + z * (z * even));
}

// ---- Logarithms and powers

/// x = mantissa · 2^exponent, mantissa in [√½, √2).
struct Scaled {
  float mantissa;
  float exponent;
};

/// For positive normal x.
RELUME_HD inline Scaled scaled(float x) {
  constexpr uint32_t kRootOfHalfBits = 0x3f3504f3u;
  const int32_t exponent = static_cast<int32_t>(bits_of(x) - kRootOfHalfBits) >> 23;
  return {float_of(bits_of(x) - (static_cast<uint32_t>(exponent) << 23)), static_cast<float>(exponent)};
}

/// Logarithm of arguments other than positive normal numbers.
RELUME_HD inline float log_of_others(float x) {
  if (flush(x) == 0.0f) return -kInfinity;
  return bits_of(x) == kInfinityBits ? kInfinity : not_a_number();
}

/// ln(1 + f) = f − half_square + tail, half_square = f² / 2.
struct LogParts {
  float f;
  float half_square;
  float tail;
};

/// For x in [√½, √2).
RELUME_HD inline LogParts log_parts(float x) {
  const float f = x - 1.0f;
  const float half_square = 0.5f * f * f;
  const float s = f / (2.0f + f);
  const float z = s * s;
  const float series = z * (0x1.555556p-1f + z * (0x1.99986ep-2f + z * (0x1.24c0e6p-2f + z * 0x1.cea564p-3f)));
  return {f, half_square, s * (half_square + series)};
}

/// Logarithm to the base 2 of x in [√½, √2), with a relative error of at most 2e-16.
RELUME_HD inline double log2_near_one(float x) {
  const double s = (static_cast<double>(x) - 1.0) / (static_cast<double>(x) + 1.0);
  const double z = s * s;
  double series = 0x1.0bb67a843fee8p-2 + z * 0x1.f1a91076f36f5p-3;
  series = 0x1.a6175669ee19ap-2 + z * (0x1.484fb38c0d5dap-2 + z * series);
  series = 0x1.ec709dc39cbb3p-1 + z * (0x1.2776c516a1473p-1 + z * series);
  return s * (0x1.71547652b82ffp1 + z * series);
}

/// 2^x, with a relative error of at most 8e-13 before it is rounded to a float. Infinity for x ≥ 128, 0 for x < −126.
RELUME_HD inline float exp2_of(double x) {
  if (x >= 128.0) return kInfinity;
  if (x < -126.0) return 0.0f;
  const double k = (x + 0x1.8p52) - 0x1.8p52;
  const double f = x - k;
  double series = 0x1.430accff2f45dp-13 + f * (0x1.00daeb4c1a33ep-16 + f * 0x1.61afb18f1a7ccp-20);
  series = 0x1.3b2ab5c4c8a64p-7 + f * (0x1.5d8748132ed9cp-10 + f * series);
  series = 0x1.ebfbdff9320a7p-3 + f * (0x1.c6b08dd48bce4p-5 + f * series);
  series = 0x1.ffffffffff79fp-1 + f * (0x1.62e42fef8609ep-1 + f * series);
  // Rounds once, and then scales without error: the result is at least 2^-126.
  const auto n = static_cast<int32_t>(k);
  return static_cast<float>(series) * power_of_two(n >> 1) * power_of_two(n - (n >> 1));
}

// ---- Inverse functions

struct Fraction {
  float numerator;
  float denominator;
};

/// Scales a fraction with 0 ≤ numerator ≤ denominator, so that the sum and the difference of both are normal or zero.
/// An infinite denominator gives 0, or 1 if the numerator is infinite too.
RELUME_HD inline Fraction scaled_fraction(float numerator, float denominator) {
  if (denominator == kInfinity) return {numerator == kInfinity ? 1.0f : 0.0f, 1.0f};
  if (denominator > 0x1p126f) return {0.25f * numerator, 0.25f * denominator};
  if (denominator < 0x1p-90f) return {0x1p32f * numerator, 0x1p32f * denominator};
  return {numerator, denominator};
}

/// Whether the quotient of a scaled_fraction() is at least 2^-126, without rounding.
RELUME_HD inline bool is_normal_fraction(const Fraction& f) {
  return f.denominator > 1.0f ? f.numerator >= f.denominator * 0x1p-126f : f.numerator > 0.0f;
}

/// eighths · π/4 for up to 4 eighths.
RELUME_HD inline TwoFloats eighth_turns(uint32_t eighths) {
  if (eighths == 3) return {0x1.2d97c8p1f, -0x1.99bc5cp-28f};
  const auto n = static_cast<float>(eighths);
  return {n * (0.25f * kPiHigh), n * (0.25f * kPiLow)};
}

/// atan(q) − q for |q| ≤ tan(π/8).
RELUME_HD inline float atan_tail(float q) {
  const float z = q * q;
  const float series = -0x1.241cf2p-3f + z * (0x1.b7ddc6p-4f + z * -0x1.07c1ccp-4f);
  return q * (z * (-0x1.555554p-2f + z * (0x1.999708p-3f + z * series)));
}

/// asin(x) / x − 1 for x² = z ≤ ¼.
RELUME_HD inline float asin_tail(float z) {
  const float series = 0x1.ff9638p-6f + z * (0x1.10a158p-6f + z * 0x1.1a3058p-5f);
  return z * (0x1.555554p-3f + z * (0x1.3334c8p-4f + z * (0x1.6d4028p-5f + z * series)));
}

}  // namespace relume::math::detail
