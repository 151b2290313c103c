// Linearly transformed cosines: lobes with closed-form integrals over polygons ([Heitz16]). relume uses them to
// estimate the importance of lights, never for shading.
#pragma once

#include "core/triple.h"
#include "core/vec.h"
#include "core/view.h"

namespace relume {

inline constexpr uint32_t kLtcTableSize = 24;

/// Inverse transform of a lobe, in the frame whose x-z plane contains the viewer: rows (a 0 b), (0 c 0), (d 0 1).
struct LtcMatrix {
  float a = 1;
  float b = 0;
  float c = 1;
  float d = 0;

  RELUME_HD float determinant() const { return c * (a - b * d); }
};

/// Fits to GGX reflection with height-correlated masking and F = 1, divided by its albedo. Columns are over
/// √(1 − cos θ) of the viewer, rows over r = √α from kLtcMinR to 1.
struct LtcTable {
  View<const LtcMatrix> entries;

  RELUME_HD LtcMatrix at(float cos_theta, float r) const;
};

inline constexpr float kLtcMinR = 0.1f;  ///< also used for smoother lobes

RELUME_HD inline LtcMatrix LtcTable::at(float cos_theta, float r) const {
  constexpr float kLast = static_cast<float>(kLtcTableSize - 1);
  const float x = saturate(safe_sqrt(1.0f - cos_theta)) * kLast;
  const float y = saturate((r - kLtcMinR) / (1.0f - kLtcMinR)) * kLast;
  const uint32_t i = static_cast<uint32_t>(relume::min(x, kLast - 1.0f));
  const uint32_t j = static_cast<uint32_t>(relume::min(y, kLast - 1.0f));
  const float fx = x - static_cast<float>(i);
  const float fy = y - static_cast<float>(j);
  const LtcMatrix* row = &entries[j * kLtcTableSize + i];
  const auto mix = [&](float LtcMatrix::*m) {
    const float low = lerp(row[0].*m, row[1].*m, fx);
    const float high = lerp(row[kLtcTableSize].*m, row[kLtcTableSize + 1].*m, fx);
    return lerp(low, high, fy);
  };
  return {mix(&LtcMatrix::a), mix(&LtcMatrix::b), mix(&LtcMatrix::c), mix(&LtcMatrix::d)};
}

/// The built-in table.
LtcTable ltc_table();

/// Density per solid angle of the transformed cosine in direction `w` (local, x-z plane through the viewer).
RELUME_HD inline float ltc_pdf(const LtcMatrix& m, const Vec3& w) {
  const Vec3 q(m.a * w.x + m.b * w.z, m.c * w.y, m.d * w.x + w.z);
  if (q.z <= 0.0f) return 0.0f;
  const float length2 = length_squared(q);
  return kInvPi * std::fabs(m.determinant()) * q.z / (length2 * length2);
}

namespace ltc {

/// z component of the integral over one polygon edge seen from the origin: its angle times the unit normal of its plane
/// (Lambert's formula). acos follows [Abramowitz64, 4.4.45], in a form without a special case at small angles.
template <typename T>
RELUME_HD inline T edge_integral(const Triple<T>& a, const Triple<T>& b) {
  const T scale = T(1.0f) / square_root(max(dot(a, a) * dot(b, b), T(1e-30f)));
  const T x = max(min(dot(a, b) * scale, T(1.0f)), T(-1.0f));
  const T y = absolute(x);
  const T polynomial = T(1.5707288f) + y * (T(-0.2121144f) + y * (T(0.0742610f) + y * T(-0.0187293f)));
  const T acute = polynomial / square_root(T(1.0f) + y);  // angle / sin of angle
  const T obtuse = T(kPi) / square_root(max(T(1.0f) - x * x, T(1e-7f))) - acute;
  return select(x > T(0.0f), acute, obtuse) * (a.x * b.y - a.y * b.x) * scale;
}

/// Triangles seen under less than the root of this (radians) count as points: rounding dominates their integral.
inline constexpr float kSmallTriangle = 4e-4f;

/// Form factor of the triangle v0 v1 v2 for a receiver at the origin facing +Z: ∫ cos θ / π dω above the horizon.
template <typename T>
RELUME_HD inline T form_factor(const Triple<T>& v0, const Triple<T>& v1, const Triple<T>& v2) {
  using Mask = MaskOf<T>;
  const T zero(0.0f);
  const Triple<T> v[4] = {v0, v1, v2, v0};
  T sum = zero;
  Triple<T> leaves{zero, zero, zero};   // crossing to below the horizon
  Triple<T> returns{zero, zero, zero};  // crossing back above it
  Mask cut = zero > zero;               // NOLINT(misc-redundant-expression): false in every lane
  for (int i = 0; i < 3; ++i) {
    const Triple<T>& a = v[i];
    const Triple<T>& b = v[i + 1];
    const Mask a_above = a.z > zero;
    const Mask b_above = b.z > zero;
    const T difference = a.z - b.z;
    const T t = a.z / relume::select(absolute(difference) > zero, difference, T(1.0f));
    const Triple<T> crossing{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), zero};
    const T integral = edge_integral(select<T>(a_above, a, crossing), select<T>(b_above, b, crossing));
    sum = sum + relume::select(a_above | b_above, integral, zero);
    const Mask down = a_above & !b_above;
    leaves = select<T>(down, crossing, leaves);
    returns = select<T>(b_above & !a_above, crossing, returns);
    cut = cut | down;
  }
  sum = sum + relume::select(cut, edge_integral(leaves, returns), zero);

  const Triple<T> e1 = v1 - v0;
  const Triple<T> e2 = v2 - v0;
  const Triple<T> middle = (v0 + v1 + v2) * T(1.0f / 3.0f);
  const T distance2 = max(dot(middle, middle), T(1e-30f));
  const T as_point =
      T(0.5f * kInvPi) * absolute(dot(cross(e1, e2), middle)) * max(middle.z, zero) / (distance2 * distance2);
  const Mask small = max(dot(e1, e1), dot(e2, e2)) < T(kSmallTriangle) * distance2;
  return relume::select(small, as_point, absolute(sum) * T(0.5f * kInvPi));
}

}  // namespace ltc

}  // namespace relume
