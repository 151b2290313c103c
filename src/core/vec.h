// Vectors, matrices and common scalar helpers for kernels.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/hd.h"
#include "core/math.h"
#include "relume/math.h"

namespace relume {

inline constexpr float kInvPi = 0.318309886183790672f;
/// Largest float below one: keeps uniform numbers in [0, 1).
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

RELUME_HD constexpr float sqr(float x) { return x * x; }
RELUME_HD constexpr float lerp(float a, float b, float t) { return (1.0f - t) * a + t * b; }
RELUME_HD constexpr float clamp(float x, float low, float high) { return x < low ? low : (x > high ? high : x); }
RELUME_HD constexpr float saturate(float x) { return clamp(x, 0.0f, 1.0f); }

/// Square root that maps small negative rounding errors to zero.
RELUME_HD inline float safe_sqrt(float x) { return std::sqrt(x > 0.0f ? x : 0.0f); }

/// Like std::fmax and std::fmin, but one instruction. If an argument is NaN, the second is returned.
RELUME_HD constexpr float max(float a, float b) { return a > b ? a : b; }
RELUME_HD constexpr float min(float a, float b) { return a < b ? a : b; }
/// For counts and indices, which floats represent exactly only up to 2^24.
RELUME_HD constexpr uint32_t max(uint32_t a, uint32_t b) { return a > b ? a : b; }
RELUME_HD constexpr uint32_t min(uint32_t a, uint32_t b) { return a < b ? a : b; }
RELUME_HD inline float max_component(const Vec3& v) { return max(v.x, max(v.y, v.z)); }
RELUME_HD inline float min_component(const Vec3& v) { return min(v.x, min(v.y, v.z)); }
RELUME_HD inline float length_squared(const Vec3& v) { return glm::dot(v, v); }
RELUME_HD inline Vec3 abs(const Vec3& v) { return {std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; }

/// Relative luminance of linear Rec. 709 (ITU-R BT.709, item 3.2).
RELUME_HD inline float luminance(const Rgb& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }

/// Whether all components are zero; none may be negative. One comparison replaces three branches.
RELUME_HD inline bool is_black(const Rgb& c) { return c.r + c.g + c.b == 0.0f; }

RELUME_HD inline bool is_finite(float x) { return std::fabs(x) <= 3.402823466e+38f; }
RELUME_HD inline bool is_finite(const Vec3& v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

/// Component-wise exponential, for absorption.
RELUME_HD inline Rgb exp(const Rgb& x) { return {math::exp(x.r), math::exp(x.g), math::exp(x.b)}; }

/// Transforms a point by an affine `m` (w = 1).
RELUME_HD inline Vec3 transform_point(const Mat4& m, const Vec3& p) {
  return Vec3(m[0]) * p.x + Vec3(m[1]) * p.y + Vec3(m[2]) * p.z + Vec3(m[3]);
}
/// Transforms a direction by `m` (w = 0); not normalised.
RELUME_HD inline Vec3 transform_vector(const Mat4& m, const Vec3& v) {
  return Vec3(m[0]) * v.x + Vec3(m[1]) * v.y + Vec3(m[2]) * v.z;
}

}  // namespace relume
