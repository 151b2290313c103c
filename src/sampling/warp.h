// Maps of the unit square onto the domains of light transport, each with its density and inverse: X_from_square, X_pdf,
// square_from_X.
#pragma once

#include "core/frame.h"
#include "core/math.h"
#include "core/vec.h"

namespace relume {

// --- Disk ---------------------------------------------------------------------------------------------

/// Sine and cosine for |x| ≤ π/4 by Taylor series, with an error below 4e-7.
RELUME_HD inline void sincos_eighth(float x, float* sine, float* cosine) {
  const float x2 = x * x;
  *sine = x * (1.0f + x2 * (-1.0f / 6 + x2 * (1.0f / 120 - x2 * (1.0f / 5040))));
  *cosine = 1.0f + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
}

/// Area-preserving and continuous ([Shirley97]); density 1/π.
RELUME_HD inline Vec2 disk_from_square(const Vec2& u) {
  const Vec2 o = 2.0f * u - Vec2(1);
  if (o.x == 0.0f && o.y == 0.0f) return {0, 0};
  const bool wide = std::fabs(o.x) > std::fabs(o.y);
  // Selects avoid branches, which random numbers would mispredict half of the time.
  const float r = wide ? o.x : o.y;
  const float other = wide ? o.y : o.x;
  float sine;
  float cosine;
  sincos_eighth((kPi / 4) * (other / r), &sine, &cosine);
  const float along = r * cosine;
  const float across = r * sine;
  return {wide ? along : across, wide ? across : along};
}

RELUME_HD inline float disk_pdf() { return kInvPi; }

RELUME_HD inline Vec2 square_from_disk(const Vec2& p) {
  const float r = std::sqrt(p.x * p.x + p.y * p.y);
  float phi = math::atan2(p.y, p.x);
  if (phi < -kPi / 4) phi += 2 * kPi;
  float a;
  float b;
  if (phi < kPi / 4) {
    a = r;
    b = phi * a / (kPi / 4);
  } else if (phi < 3 * kPi / 4) {
    b = r;
    a = -(phi - kPi / 2) * b / (kPi / 4);
  } else if (phi < 5 * kPi / 4) {
    a = -r;
    b = (phi - kPi) * a / (kPi / 4);
  } else {
    b = -r;
    a = -(phi - 3 * kPi / 2) * b / (kPi / 4);
  }
  return {0.5f * (a + 1), 0.5f * (b + 1)};
}

// --- Directions about +Z ------------------------------------------------------------------------------

/// Density proportional to cos θ over the upper hemisphere.
RELUME_HD inline Vec3 cosine_hemisphere_from_square(const Vec2& u) {
  const Vec2 d = disk_from_square(u);
  return {d.x, d.y, safe_sqrt(1.0f - d.x * d.x - d.y * d.y)};
}
/// pdf_w; zero below the horizon.
RELUME_HD inline float cosine_hemisphere_pdf(float cos_theta) { return cos_theta > 0.0f ? cos_theta * kInvPi : 0.0f; }
RELUME_HD inline Vec2 square_from_cosine_hemisphere(const Vec3& w) { return square_from_disk({w.x, w.y}); }

/// Uniform over all directions; pdf_w = 1/4π.
RELUME_HD inline Vec3 sphere_from_square(const Vec2& u) {
  const float z = 1.0f - 2.0f * u.x;
  const float r = safe_sqrt(1.0f - z * z);
  return {r * math::unit_vector(2.0f * kPi * u.y), z};
}
RELUME_HD inline float sphere_pdf() { return 0.25f * kInvPi; }
RELUME_HD inline Vec2 square_from_sphere(const Vec3& w) {
  const float phi = math::atan2(w.y, w.x);
  return {0.5f * (1.0f - w.z), (phi < 0.0f ? phi + 2 * kPi : phi) * (0.5f * kInvPi)};
}

/// Uniform over the cone about +Z with 1 − cos of its half-angle given by `one_minus_cos`. This form stays precise for
/// cones as narrow as the sun's.
RELUME_HD inline Vec3 cone_from_square(const Vec2& u, float one_minus_cos) {
  const float h = u.x * one_minus_cos;  // 1 − cos θ of the sample
  const float r = safe_sqrt(h * (2.0f - h));
  return {r * math::unit_vector(2.0f * kPi * u.y), 1.0f - h};
}
RELUME_HD inline float cone_pdf(float one_minus_cos) { return 1.0f / (2.0f * kPi * one_minus_cos); }
RELUME_HD inline Vec2 square_from_cone(const Vec3& w, float one_minus_cos) {
  const float h = (w.x * w.x + w.y * w.y) / (1.0f + w.z);  // 1 − cos θ without cancellation
  const float phi = math::atan2(w.y, w.x);
  return {h / one_minus_cos, (phi < 0.0f ? phi + 2 * kPi : phi) * (0.5f * kInvPi)};
}

// --- Triangle -----------------------------------------------------------------------------------------

/// Uniform barycentrics (weights of vertices 1 and 2) by folding, which keeps strata compact ([Heitz19]).
RELUME_HD inline Vec2 triangle_from_square(const Vec2& u) {
  const float half = 0.5f * min(u.x, u.y);
  const bool left = u.y > u.x;
  return {left ? half : u.x - half, left ? u.y - half : half};
}
/// Density in barycentric space: the triangle's parameter area is 1/2.
RELUME_HD inline float triangle_pdf() { return 2.0f; }
RELUME_HD inline Vec2 square_from_triangle(const Vec2& b) {
  return b.y > b.x ? Vec2{2.0f * b.x, b.y + b.x} : Vec2{b.x + b.y, 2.0f * b.y};
}

// --- Measures -----------------------------------------------------------------------------------------

/// Converts pdf_a at a point `distance_squared` away, whose normal makes `cos_theta` with the connection, to pdf_w.
RELUME_HD inline float pdf_w_from_pdf_a(float pdf_a, float distance_squared, float cos_theta) {
  return pdf_a * distance_squared / cos_theta;
}

}  // namespace relume
