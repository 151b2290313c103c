// Watertight intersection of a ray with triangles ([Woop13]).
#pragma once

#include "core/ray.h"

namespace relume {

/// Where a ray crosses a triangle.
struct Crossing {
  float t = 0;           ///< lengths of the ray's direction; positive
  bool at_back = false;  ///< whether the corners appear clockwise to the ray's origin
};

/// A ray whose direction becomes the z axis by a permutation of axes and a shear. Triangles that share an edge compute
/// the same two-dimensional end points for it, and the side on which the ray passes is exact. No ray passes between
/// them, in any order of tests. This requires code without fused multiply-adds (-ffp-contract=off).
class ShearedRay {
 public:
  RELUME_HD ShearedRay(const Vec3& origin, const Vec3& direction) : origin_(origin) {
    const Vec3 d = abs(direction);
    z_ = d.x > d.y ? (d.x > d.z ? 0u : 2u) : (d.y > d.z ? 1u : 2u);
    const uint32_t next = z_ == 2 ? 0 : z_ + 1;
    const uint32_t last = z_ == 0 ? 2 : z_ - 1;
    direction_z_ = component(direction, z_);
    x_ = direction_z_ < 0.0f ? last : next;  // keeps the orientation of triangles
    y_ = direction_z_ < 0.0f ? next : last;
    shear_x_ = component(direction, x_) / direction_z_;
    shear_y_ = component(direction, y_) / direction_z_;
  }

  /// Whether the ray crosses the triangle at a distance of at most `t_max`. A ray within the triangle's plane does not.
  RELUME_HD_INLINE bool crosses(const Vec3& p0, const Vec3& p1, const Vec3& p2, float t_max, Crossing& crossing) const {
    const Vec3 a = sheared(p0);
    const Vec3 b = sheared(p1);
    const Vec3 c = sheared(p2);
    const float u = c.x * b.y - c.y * b.x;
    const float v = a.x * c.y - a.y * c.x;
    const float w = b.x * a.y - b.y * a.x;
    // Rounding is monotonic: each of these has the correct sign or is zero.
    if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
    return crosses_exactly(a, b, c, t_max, crossing);
  }

 private:
  RELUME_HD_INLINE static float component(const Vec3& v, uint32_t axis) {
    return axis == 0 ? v.x : (axis == 1 ? v.y : v.z);
  }

  RELUME_HD_INLINE Vec3 sheared(const Vec3& p) const {
    const Vec3 q = p - origin_;
    const float z = component(q, z_);
    return {component(q, x_) - shear_x_ * z, component(q, y_) - shear_y_ * z, z};
  }

  /// Weights in double precision: products of floats are exact, and each difference is rounded once. The point at t is
  /// thus on the triangle and on the ray up to a few units in the last place, however thin or steep the triangle is.
  RELUME_HD_INLINE bool crosses_exactly(const Vec3& a, const Vec3& b, const Vec3& c, float t_max,
                                        Crossing& crossing) const {
    const auto product = [](float x, float y) { return static_cast<double>(x) * static_cast<double>(y); };
    const double u = product(c.x, b.y) - product(c.y, b.x);
    const double v = product(a.x, c.y) - product(a.y, c.x);
    const double w = product(b.x, a.y) - product(b.y, a.x);
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return false;
    const double sum = u + v + w;
    const double z = u * static_cast<double>(a.z) + v * static_cast<double>(b.z) + w * static_cast<double>(c.z);
    const auto t = static_cast<float>(z / (sum * static_cast<double>(direction_z_)));
    if (!(t > 0.0f && t <= t_max)) return false;  // also if the sum is zero
    crossing = {t, sum < 0.0};
    return true;
  }

  Vec3 origin_;
  uint32_t x_, y_, z_;
  float shear_x_, shear_y_, direction_z_;
};

}  // namespace relume
