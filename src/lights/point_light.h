// Light from one point, equal in all directions.
#pragma once

#include "lights/light_types.h"

namespace relume {

struct PointLight {
  Vec3 position;
  Rgb intensity;  ///< W/sr
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

}  // namespace relume
