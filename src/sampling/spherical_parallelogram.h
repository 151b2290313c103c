// Uniform directions in a parallelogram on the unit sphere: two spherical triangles that share the diagonal from one
// corner. The first random number turns an arc around that corner, the second chooses a point on it, so the map is
// continuous. It needs fewer inverse trigonometric functions than the map of [Urena13] for rectangles, and edges need
// not be perpendicular.
#pragma once

#include "sampling/spherical_triangle.h"

namespace relume {

/// A parallelogram seen from the origin. T: float or Lanes.
template <typename T>
struct SphericalParallelogram {
  SphericalTriangle<T> first;   ///< on the side of e1
  SphericalTriangle<T> second;  ///< on the side of e2
  T half_solid_angle;           ///< steradians

  RELUME_HD_INLINE T pdf() const { return T(0.5f) / half_solid_angle; }
};

/// `v0`: the corner around which the arc turns; the others are v0 + e1, v0 + e1 + e2 and v0 + e2. `volume`:
/// |v0 · (e1 × e2)|, m³.
template <typename T>
RELUME_HD_INLINE SphericalParallelogram<T> make_spherical_parallelogram(const Triple<T>& v0, const Triple<T>& e1,
                                                                        const Triple<T>& e2, const T& volume) {
  const Triple<T> opposite = v0 + e1 + e2;
  SphericalParallelogram<T> p;
  p.first = make_spherical_triangle(v0 + e1, v0, opposite, volume);
  p.second = make_spherical_triangle(opposite, v0, v0 + e2, volume);
  p.half_solid_angle = p.first.half_solid_angle + p.second.half_solid_angle;
  return p;
}

template <typename T>
RELUME_HD_INLINE Triple<T> spherical_parallelogram_from_square(const SphericalParallelogram<T>& p, const T& u,
                                                               const T& v) {
  const T angle = u * p.half_solid_angle;
  const MaskOf<T> in_first = angle < p.first.half_solid_angle;
  const SphericalTriangle<T> t = select(in_first, p.first, p.second);
  const T rest = select(in_first, angle, angle - p.first.half_solid_angle);
  return spherical_triangle_from_square(t, min(rest / max(t.half_solid_angle, T(1e-37f)), T(1.0f)), v);
}

/// Inverse of spherical_parallelogram_from_square() for a unit direction `w` in the parallelogram.
RELUME_HD inline Vec2 square_from_spherical_parallelogram(const SphericalParallelogram<float>& p,
                                                          const Triple<float>& w) {
  // w lies on the side of the diagonal on which the corner of its triangle does.
  const Triple<float> diagonal = cross(p.first.b, p.first.c);
  const bool in_first = dot(diagonal, w) * dot(diagonal, p.first.a) > 0.0f;
  const SphericalTriangle<float>& t = in_first ? p.first : p.second;
  const Vec2 u = square_from_spherical_triangle(t, w);
  const float before = in_first ? 0.0f : p.first.half_solid_angle;
  return {(before + u.x * t.half_solid_angle) / p.half_solid_angle, u.y};
}

}  // namespace relume
