// Light from one point into a cone with a soft edge (KHR_lights_punctual).
#pragma once

#include <cmath>

#include "lights/light_types.h"

namespace relume {

struct SpotLight {
  Vec3 position;
  Vec3 axis;        ///< unit, emission direction
  Rgb intensity;    ///< on the axis, W/sr
  float cos_inner;  ///< full intensity above this cosine
  float cos_outer;  ///< no light below this cosine

  bool operator==(const SpotLight&) const = default;
};

/// Angular attenuation of KHR_lights_punctual: the square of a linear ramp in cos θ.
RELUME_HD inline float spot_falloff(const SpotLight& light, float cos_theta) {
  constexpr float kLeast = 1e-7f;  // about the least difference of distinct cosines
  const float ramp = saturate((cos_theta - light.cos_outer) / relume::max(light.cos_inner - light.cos_outer, kLeast));
  return ramp * ramp;
}

RELUME_HD inline LightSample sample_li(const SpotLight& light, const Vec3& p) {
  const Vec3 d = light.position - p;
  const float distance_squared = length_squared(d);
  LightSample s;
  if (!(distance_squared > 0.0f)) return s;
  s.distance = std::sqrt(distance_squared);
  s.wi = d / s.distance;
  s.radiance = light.intensity * (spot_falloff(light, glm::dot(-s.wi, light.axis)) / distance_squared);
  s.pdf_w = 1.0f;
  s.delta = true;
  s.position = light.position;
  return s;
}

RELUME_HD inline EmissionSample sample_le(const SpotLight& light, const Vec2& u) {
  const float one_minus_cos = 1.0f - light.cos_outer;
  EmissionSample s;
  s.origin = light.position;
  const Vec3 local = cone_from_square(u, one_minus_cos);
  s.direction = make_frame(light.axis).to_world(local);
  s.le = light.intensity * spot_falloff(light, local.z);
  s.pdf_a = 1.0f;
  s.pdf_w = cone_pdf(one_minus_cos);
  s.delta_position = true;
  return s;
}

RELUME_HD inline EmissionPdf pdf_le(const SpotLight& light, const Vec3& direction) {
  const bool inside = glm::dot(direction, light.axis) >= light.cos_outer;
  return {0.0f, inside ? cone_pdf(1.0f - light.cos_outer) : 0.0f};
}

/// Integral of the falloff over the cone: the inner cap, plus a third of the ramp.
RELUME_HD inline Rgb power(const SpotLight& light) {
  return light.intensity * (2.0f * kPi * ((1.0f - light.cos_inner) + (light.cos_inner - light.cos_outer) / 3.0f));
}

inline LightExtent extent_of(const SpotLight& light) {
  const double inner = std::acos(static_cast<double>(light.cos_inner));
  const double falloff = std::acos(static_cast<double>(light.cos_outer)) - inner;
  const double intensity = static_cast<double>(relume::min(luminance(light.intensity), kMostSelectionWeight));
  return {{light.position, light.position}, light.axis, inner, falloff, false, intensity};
}

}  // namespace relume
