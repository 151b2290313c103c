// Sampling of triangles and parallelograms uniformly in solid angle, for one light or for eight side by side, with the
// same bits.
#pragma once

#include "sampling/spherical_parallelogram.h"

namespace relume {

/// A triangle, or a parallelogram with the corner `corner` + e1 + e2, seen from the origin. T: float or Lanes.
template <typename T>
struct EmitterShape {
  Triple<T> corner, e1, e2;
  T volume;  ///< |corner · (e1 × e2)|, m³
  bool is_parallelogram;
};

template <typename T>
RELUME_HD_INLINE SphericalTriangle<T> triangle_on_sphere(const EmitterShape<T>& s) {
  return make_spherical_triangle(s.corner, s.corner + s.e1, s.corner + s.e2, s.volume);
}
template <typename T>
RELUME_HD_INLINE SphericalParallelogram<T> parallelogram_on_sphere(const EmitterShape<T>& s) {
  return make_spherical_parallelogram(s.corner, s.e1, s.e2, s.volume);
}

/// Barycentrics in direction `w`, clamped to the shape, because rounding may move w outside it.
template <typename T>
RELUME_HD_INLINE void barycentric_along(const EmitterShape<T>& s, const Triple<T>& w, T& x, T& y) {
  const Triple<T> n = cross(s.e1, s.e2);
  const T square = dot(n, n);
  const Triple<T> inside = w * (dot(s.corner, n) / dot(w, n)) - s.corner;
  x = min(max(dot(cross(inside, s.e2), n) / square, T(0.0f)), T(1.0f));
  y = max(dot(cross(s.e1, inside), n) / square, T(0.0f));
  y = min(y, s.is_parallelogram ? T(1.0f) : T(1.0f) - x);
}

/// Barycentrics of a direction that is uniform in solid angle, and its pdf_w.
template <typename T>
RELUME_HD_INLINE T sample_solid_angle(const EmitterShape<T>& s, const T& u, const T& v, T& x, T& y) {
  if (s.is_parallelogram) {
    const SphericalParallelogram<T> p = parallelogram_on_sphere(s);
    barycentric_along(s, spherical_parallelogram_from_square(p, u, v), x, y);
    return p.pdf();
  }
  const SphericalTriangle<T> t = triangle_on_sphere(s);
  barycentric_along(s, spherical_triangle_from_square(t, u, v), x, y);
  return t.pdf();
}
RELUME_HD inline float pdf_solid_angle(const EmitterShape<float>& s) {
  return s.is_parallelogram ? parallelogram_on_sphere(s).pdf() : triangle_on_sphere(s).pdf();
}

}  // namespace relume
