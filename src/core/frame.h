// Orthonormal frames: local space has +Z along the normal.
#pragma once

#include "core/vec.h"

namespace relume {

struct Frame {
  Vec3 t;
  Vec3 b;
  Vec3 n;

  RELUME_HD_INLINE Vec3 to_local(const Vec3& v) const { return {glm::dot(v, t), glm::dot(v, b), glm::dot(v, n)}; }
  RELUME_HD_INLINE Vec3 to_world(const Vec3& v) const { return v.x * t + v.y * b + v.z * n; }
};

/// Frame around the unit vector `n`, continuous except at n.z = 0 ([Duff17], listing 3).
RELUME_HD inline Frame make_frame(const Vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

}  // namespace relume
