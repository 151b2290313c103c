// Vectors whose components are floats or lanes.
#pragma once

#include "core/lanes.h"
#include "core/vec.h"

namespace relume {

/// Three numbers of type T: float or SIMD lanes.
template <typename T>
struct Triple {
  T x, y, z;

  friend RELUME_HD Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend RELUME_HD Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend RELUME_HD Triple operator*(const Triple& a, const T& s) { return {a.x * s, a.y * s, a.z * s}; }
  friend RELUME_HD Triple operator/(const Triple& a, const T& s) { return {a.x / s, a.y / s, a.z / s}; }
};
template <typename T>
RELUME_HD inline T dot(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
RELUME_HD inline Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The same vector in every lane.
template <typename T>
RELUME_HD_INLINE Triple<T> triple_of(const Vec3& v) {
  return {T(v.x), T(v.y), T(v.z)};
}
/// `yes` where the condition is true, `no` elsewhere.
template <typename T>
RELUME_HD inline Triple<T> select(const MaskOf<T>& condition, const Triple<T>& yes, const Triple<T>& no) {
  return {select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z)};
}

/// Product by component.
template <typename T>
RELUME_HD inline Triple<T> product_of(const Triple<T>& a, const Triple<T>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
/// By component, as glm::min() and glm::max().
template <typename T>
RELUME_HD inline Triple<T> min_of(const Triple<T>& a, const Triple<T>& b) {
  return {select(b.x < a.x, b.x, a.x), select(b.y < a.y, b.y, a.y), select(b.z < a.z, b.z, a.z)};
}
template <typename T>
RELUME_HD inline Triple<T> max_of(const Triple<T>& a, const Triple<T>& b) {
  return {select(a.x < b.x, b.x, a.x), select(a.y < b.y, b.y, a.y), select(a.z < b.z, b.z, a.z)};
}

}  // namespace relume
