// Uniform directions in a triangle on the unit sphere, stratified as in [Arvo95]. The first random number chooses a
// point c' on the arc a c by the area of the triangle a b c', the second a point on the arc b c'. Half angles need one
// arc tangent in place of Arvo's three angles ([Peters21]).
#pragma once

#include "core/lane_math.h"
#include "core/triple.h"

namespace relume {

/// A triangle seen from the origin. T: float or Lanes.
template <typename T>
struct SphericalTriangle {
  Triple<T> a, b, c;   ///< unit directions to the corners
  T determinant;       ///< |a · (b × c)|
  T base;              ///< 1 + a · b
  T slope;             ///< (a + b) · c
  T half_solid_angle;  ///< steradians

  RELUME_HD_INLINE T pdf() const { return T(0.5f) / half_solid_angle; }
};

/// `yes` where the condition is true, `no` elsewhere.
template <typename T>
RELUME_HD_INLINE SphericalTriangle<T> select(const MaskOf<T>& condition, const SphericalTriangle<T>& yes,
                                             const SphericalTriangle<T>& no) {
  return {select(condition, yes.a, no.a),
          select(condition, yes.b, no.b),
          select(condition, yes.c, no.c),
          select(condition, yes.determinant, no.determinant),
          select(condition, yes.base, no.base),
          select(condition, yes.slope, no.slope),
          select(condition, yes.half_solid_angle, no.half_solid_angle)};
}

/// `volume`: |v0 · (v1 × v2)| of the corners, m³. The caller's form of it avoids cancellation where the triangle is
/// small.
template <typename T>
RELUME_HD_INLINE SphericalTriangle<T> make_spherical_triangle(const Triple<T>& v0, const Triple<T>& v1,
                                                              const Triple<T>& v2, const T& volume) {
  const auto inverse_length = [](const Triple<T>& v) { return T(1.0f) / square_root(max(dot(v, v), T(1e-37f))); };
  const T s0 = inverse_length(v0);
  const T s1 = inverse_length(v1);
  const T s2 = inverse_length(v2);
  SphericalTriangle<T> t;
  t.a = v0 * s0;
  t.b = v1 * s1;
  t.c = v2 * s2;
  t.determinant = ((volume * s0) * s1) * s2;
  t.base = T(1.0f) + dot(t.a, t.b);
  t.slope = dot(t.a + t.b, t.c);
  // tan(Ω/2) by [Oosterom83].
  t.half_solid_angle = upper_angle(t.determinant, t.base + t.slope);
  return t;
}

/// The point c' of the arc a c with which a b c' has the fraction u of the solid angle. It mirrors a at o = x a + y c,
/// the middle of the arc a c', because tan(σ/2) = |a · (b × o)| / ((a + b) · o) for the solid angle σ of a b c'.
template <typename T>
RELUME_HD_INLINE Triple<T> corner_at(const SphericalTriangle<T>& t, const T& u) {
  T sine;
  T cosine;
  sine_and_cosine(u * t.half_solid_angle, sine, cosine);
  const Triple<T> o = t.a * (cosine * t.determinant - sine * t.slope) + t.c * (sine * t.base);
  return o * (T(2.0f) * dot(t.a, o) / max(dot(o, o), T(1e-37f))) - t.a;
}

template <typename T>
RELUME_HD_INLINE Triple<T> spherical_triangle_from_square(const SphericalTriangle<T>& t, const T& u, const T& v) {
  const Triple<T> corner = corner_at(t, u);
  // 1 − cos of the arc b c', without cancellation. From b to the point, 1 − cos is v · depth.
  const Triple<T> chord = corner - t.b;
  const T depth = T(0.5f) * dot(chord, chord);
  const T along = square_root(v * (T(2.0f) - v * depth) / max(T(2.0f) - depth, T(1e-6f)));
  return t.b * (T(1.0f) - along - depth * (v - along)) + corner * along;
}

/// Inverse of spherical_triangle_from_square() for a unit direction `w` in the triangle.
RELUME_HD inline Vec2 square_from_spherical_triangle(const SphericalTriangle<float>& t, const Triple<float>& w) {
  Triple<float> corner = cross(cross(t.b, w), cross(t.c, t.a));
  const float length = std::sqrt(dot(corner, corner));
  if (!(length > 0.0f)) return {0, 0};
  corner = corner * ((dot(corner, t.a + t.c) < 0.0f ? -1.0f : 1.0f) / length);
  const float volume = std::fabs(dot(t.a, cross(t.b, corner)));
  const float half = upper_angle(volume, t.base + dot(t.a + t.b, corner));
  const Triple<float> part = w - t.b;
  const Triple<float> whole = corner - t.b;
  return {half / t.half_solid_angle, dot(part, part) / relume::max(dot(whole, whole), 1e-37f)};
}

}  // namespace relume
