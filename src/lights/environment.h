// Light from all directions: constant, or an equirectangular map sampled in proportion to its luminance.
#pragma once

#include "core/lane_math.h"
#include "core/view.h"
#include "lights/light_types.h"
#include "sampling/distribution_2d.h"

namespace relume {

struct EnvironmentView {
  Rgb scale{0};         ///< constant: radiance; map: factor
  View<const Rgb> map;  ///< empty: constant
  uint32_t width = 0;
  uint32_t height = 0;
  float cos_rotation = 1;
  float sin_rotation = 0;
  Distribution2D distribution;
  Rgb mean{0};  ///< mean radiance over all directions

  RELUME_HD bool black() const { return is_black(scale); }
  /// A constant environment is left to BSDF sampling, which is at least as good.
  RELUME_HD bool worth_sampling() const { return !black() && !distribution.empty(); }

  /// Also exact at the poles, where 1 − y² cancels.
  RELUME_HD static float sine_of_polar_angle(const Vec3& w) { return std::sqrt(sqr(w.x) + sqr(w.z)); }

  /// The centre of the map looks along −Z, +X lies to its right, row 0 is +Y; the rotation is about +Y.
  RELUME_HD Vec2 uv_from_direction(const Vec3& w) const {
    const float x = cos_rotation * w.x - sin_rotation * w.z;
    const float z = sin_rotation * w.x + cos_rotation * w.z;
    const float half_turn = upper_angle(std::fabs(x), -z) * (0.5f * kInvPi);
    return {0.5f + std::copysign(half_turn, x), upper_angle(sine_of_polar_angle(w), w.y) * kInvPi};
  }

  RELUME_HD Vec3 direction_from_uv(const Vec2& uv, float* sin_theta) const {
    const float phi = (uv.x - 0.5f) * (2.0f * kPi);
    float sin_phi;
    float cos_phi;
    float cos_theta;
    sine_and_cosine(std::fabs(phi), sin_phi, cos_phi);
    sine_and_cosine(uv.y * kPi, *sin_theta, cos_theta);
    return direction_from_map({*sin_theta * std::copysign(sin_phi, phi), cos_theta, -*sin_theta * cos_phi});
  }

  /// Rotates a direction of the unrotated map.
  RELUME_HD Vec3 direction_from_map(const Vec3& w) const {
    return {cos_rotation * w.x + sin_rotation * w.z, w.y, -sin_rotation * w.x + cos_rotation * w.z};
  }

  /// Radiance that arrives along −w.
  RELUME_HD Rgb radiance(const Vec3& w) const { return map.empty() ? scale : radiance_at(uv_from_direction(w)); }

  /// Radiance of the map, interpolated bilinearly.
  RELUME_HD Rgb radiance_at(const Vec2& uv) const {
    const float x = uv.x * static_cast<float>(width) - 0.5f;
    const float y = uv.y * static_cast<float>(height) - 0.5f;
    const float fx = std::floor(x);
    const float fy = std::floor(y);
    const Rgb top = texel(static_cast<int>(fx), static_cast<int>(fy)) * (1.0f - (x - fx)) +
                    texel(static_cast<int>(fx) + 1, static_cast<int>(fy)) * (x - fx);
    const Rgb bottom = texel(static_cast<int>(fx), static_cast<int>(fy) + 1) * (1.0f - (x - fx)) +
                       texel(static_cast<int>(fx) + 1, static_cast<int>(fy) + 1) * (x - fx);
    return scale * (top * (1.0f - (y - fy)) + bottom * (y - fy));
  }

 private:
  RELUME_HD Rgb texel(int x, int y) const {
    const int w = static_cast<int>(width);
    const int h = static_cast<int>(height);
    x = x < 0 ? x + w : (x >= w ? x - w : x);
    y = y < 0 ? 0 : (y >= h ? h - 1 : y);
    return map[static_cast<uint32_t>(y) * width + static_cast<uint32_t>(x)];
  }
};

RELUME_HD inline float pdf_li(const EnvironmentView& environment, const Vec3& wi) {
  if (environment.distribution.empty()) return environment.black() ? 0.0f : sphere_pdf();
  const float sin_theta = EnvironmentView::sine_of_polar_angle(wi);
  if (!(sin_theta > 0.0f)) return 0.0f;
  return environment.distribution.pdf(environment.uv_from_direction(wi)) / (2.0f * kPi * kPi * sin_theta);
}

RELUME_HD inline LightSample sample_li(const EnvironmentView& environment, const Vec2& u) {
  LightSample s;
  s.distance = kInfinity;
  if (environment.distribution.empty()) {
    s.wi = sphere_from_square(u);
    s.pdf_w = sphere_pdf();
    s.radiance = environment.radiance(s.wi);
  } else {
    const Distribution2D::Sample point = environment.distribution.sample(u);
    float sin_theta;
    s.wi = environment.direction_from_uv(point.point, &sin_theta);
    if (!(sin_theta > 0.0f)) return s;
    s.pdf_w = point.pdf / (2.0f * kPi * kPi * sin_theta);
    s.radiance = environment.radiance_at(point.point);
  }
  return s;
}

/// Power through the bounding sphere: π R² times the integral of the radiance over all directions.
RELUME_HD inline Rgb power(const EnvironmentView& environment, const SceneBounds& bounds) {
  return environment.mean * (4.0f * kPi * kPi * sqr(bounds.radius));
}

}  // namespace relume
