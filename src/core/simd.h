// Eight floats at once on processors that have them. Code written for a type T of numbers runs with T = float
// everywhere and with T = Float8 on hosts with AVX2, to the same bits.
#pragma once

#include "core/vec.h"

#if defined(__AVX2__) && !defined(__CUDACC__)
#define RELUME_HAS_FLOAT8 1
#include <immintrin.h>
#else
#define RELUME_HAS_FLOAT8 0
#endif

namespace relume {

/// What comparing numbers of type T gives.
template <typename T>
using MaskOf = decltype(T() < T());

/// Which of two values, by a comparison's result.
RELUME_HD constexpr float select(bool condition, float yes, float no) { return condition ? yes : no; }
RELUME_HD inline float sqrt_of(float x) { return std::sqrt(x); }
RELUME_HD inline float abs_of(float x) { return std::fabs(x); }

#if RELUME_HAS_FLOAT8

inline constexpr uint32_t kSimdWidth = 8;

/// Comparison results: all ones or all zeros a lane.
struct Mask8 {
  __m256 m;

  friend Mask8 operator&(Mask8 a, Mask8 b) { return {_mm256_and_ps(a.m, b.m)}; }
  friend Mask8 operator|(Mask8 a, Mask8 b) { return {_mm256_or_ps(a.m, b.m)}; }
  friend Mask8 operator!(Mask8 a) { return {_mm256_xor_ps(a.m, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))}; }
  bool any() const { return _mm256_movemask_ps(m) != 0; }
};

struct Float8 {
  __m256 v;

  Float8() : v(_mm256_setzero_ps()) {}
  Float8(float x) : v(_mm256_set1_ps(x)) {}  // NOLINT: constants mix with lanes
  explicit Float8(__m256 x) : v(x) {}

  /// table[indices[0 … 7]].
  static Float8 gather(const float* table, const uint32_t* indices) {
    const __m256i at = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(indices));
    return Float8(_mm256_i32gather_ps(table, at, 4));
  }
  static Float8 load(const float* from) { return Float8(_mm256_loadu_ps(from)); }
  void store(float* to) const { _mm256_storeu_ps(to, v); }

  friend Float8 operator+(Float8 a, Float8 b) { return Float8(_mm256_add_ps(a.v, b.v)); }
  friend Float8 operator-(Float8 a, Float8 b) { return Float8(_mm256_sub_ps(a.v, b.v)); }
  friend Float8 operator*(Float8 a, Float8 b) { return Float8(_mm256_mul_ps(a.v, b.v)); }
  friend Float8 operator/(Float8 a, Float8 b) { return Float8(_mm256_div_ps(a.v, b.v)); }
  friend Float8 operator-(Float8 a) { return Float8(_mm256_xor_ps(a.v, _mm256_set1_ps(-0.0f))); }
  friend Mask8 operator<(Float8 a, Float8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)}; }
  friend Mask8 operator>(Float8 a, Float8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)}; }
};

inline Float8 select(Mask8 condition, Float8 yes, Float8 no) {
  return Float8(_mm256_blendv_ps(no.v, yes.v, condition.m));
}
inline Float8 max(Float8 a, Float8 b) { return Float8(_mm256_max_ps(a.v, b.v)); }
inline Float8 min(Float8 a, Float8 b) { return Float8(_mm256_min_ps(a.v, b.v)); }
inline Float8 sqrt_of(Float8 x) { return Float8(_mm256_sqrt_ps(x.v)); }
inline Float8 abs_of(Float8 x) { return Float8(_mm256_andnot_ps(_mm256_set1_ps(-0.0f), x.v)); }

#endif

}  // namespace relume
