// Uniform light from one point.
#pragma once

#include <cmath>

#include "lights/light_types.h"

namespace relume {

struct PointLight {
  Vec3 position;
  Rgb intensity;  ///< W/sr

  bool operator==(const PointLight&) const = default;
};

RELUME_HD inline LightSample sample_li(const PointLight& light, const Vec3& p) {
  const Vec3 d = light.position - p;
  const float distance_squared = length_squared(d);
  LightSample s;
  if (!(distance_squared > 0.0f)) return s;
  s.distance = std::sqrt(distance_squared);
  s.wi = d / s.distance;
  s.radiance = light.intensity / distance_squared;
  s.pdf_w = 1.0f;
  s.delta = true;
  s.position = light.position;
  return s;
}

RELUME_HD inline EmissionSample sample_le(const PointLight& light, const Vec2& u) {
  EmissionSample s;
  s.origin = light.position;
  s.direction = sphere_from_square(u);
  s.le = light.intensity;
  s.pdf_a = 1.0f;
  s.pdf_w = sphere_pdf();
  s.delta_position = true;
  return s;
}

RELUME_HD inline EmissionPdf pdf_le(const PointLight&) { return {0.0f, sphere_pdf()}; }

RELUME_HD inline Rgb power(const PointLight& light) { return light.intensity * (4.0f * kPi); }

inline LightExtent extent_of(const PointLight& light, double watts) {
  return {{light.position, light.position}, Vec3(0, 0, 1), M_PI, M_PI / 2, false, watts / (4 * M_PI)};
}

}  // namespace relume
