// Rays, hits, and ray origins that avoid self-intersection.
#pragma once

#include "core/key_time.h"
#include "core/vec.h"

namespace relume {

struct Ray {
  Vec3 origin{0};
  Vec3 direction{0, 0, 1};      ///< unit length
  float t_max = kInfinity;      ///< metres
  float time = kShutterMiddle;  ///< within the shutter, in [0, 1]; all rays of a path have the same
};

/// Marks a ray that left the scene.
inline constexpr uint32_t kNoHit = 0xffffffffu;
/// The same in buffers of surface numbers.
inline constexpr uint32_t kNoSurface = kNoHit;

/// Intersection of a ray. `u`, `v` are the weights of vertices 1 and 2 of the triangle.
struct Hit {
  uint32_t instance = kNoHit;
  uint32_t primitive = 0;
  float u = 0.0f;
  float v = 0.0f;
  float t = kInfinity;

  RELUME_HD bool valid() const { return instance != kNoHit; }
};

/// Ray origin on the side of the surface that `w` points to. `p` is a surface point with an error of at most `error`
/// (metres) per component, `n` its geometric normal. The shift is the extent of the error box along the normal, so the
/// true surface cannot lie between ([Pharr23], §6.8.6).
RELUME_HD inline Vec3 offset_origin(const Vec3& p, float error, const Vec3& n, const Vec3& w) {
  const float d = error * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
  return p + (glm::dot(w, n) < 0.0f ? -d : d) * n;
}

/// Bound on the relative error of `n` chained float operations ([Pharr23], §6.8.1).
RELUME_HD constexpr float gamma_bound(int n) {
  constexpr float kUnitRoundoff = 0x1p-24f;
  return (static_cast<float>(n) * kUnitRoundoff) / (1.0f - static_cast<float>(n) * kUnitRoundoff);
}

}  // namespace relume
