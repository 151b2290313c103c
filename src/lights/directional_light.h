// Light from infinity from one direction (delta) or from a small disk of the sky such as the sun's.
#pragma once

#include "lights/light_types.h"

namespace relume {

struct DirectionalLight {
  Vec3 to_light;        ///< unit, towards the centre
  Rgb irradiance;       ///< on a plane facing the light, W/m²
  float one_minus_cos;  ///< of the disk's angular radius; 0: delta

  bool operator==(const DirectionalLight&) const = default;

  RELUME_HD bool delta() const { return one_minus_cos == 0.0f; }
  /// Radiance of the disk: irradiance divided by its projected solid angle π sin²θ.
  RELUME_HD Rgb radiance() const { return irradiance / (kPi * one_minus_cos * (2.0f - one_minus_cos)); }
  /// Whether `wi` points into the disk. Compares 1 − cos of the angle to the centre, computed without cancellation.
  RELUME_HD bool contains(const Vec3& wi) const {
    return !delta() && 0.5f * length_squared(wi - to_light) <= one_minus_cos;
  }
};

/// Radiance that arrives along −wi from infinity.
RELUME_HD inline Rgb radiance_from(const DirectionalLight& light, const Vec3& wi) {
  return light.contains(wi) ? light.radiance() : Rgb(0);
}

RELUME_HD inline LightSample sample_li(const DirectionalLight& light, const Vec2& u) {
  LightSample s;
  s.distance = kInfinity;
  s.delta = light.delta();
  if (s.delta) {
    s.wi = light.to_light;
    s.radiance = light.irradiance;
    s.pdf_w = 1.0f;
    return s;
  }
  s.wi = make_frame(light.to_light).to_world(cone_from_square(u, light.one_minus_cos));
  s.radiance = light.radiance();
  s.pdf_w = cone_pdf(light.one_minus_cos);
  return s;
}

RELUME_HD inline float pdf_li(const DirectionalLight& light, const Vec3& wi) {
  return light.contains(wi) ? cone_pdf(light.one_minus_cos) : 0.0f;
}

RELUME_HD inline Rgb power(const DirectionalLight& light, const SceneBounds& bounds) {
  return light.irradiance * (kPi * sqr(bounds.radius));
}

}  // namespace relume
