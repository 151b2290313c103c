// Reflectance of smooth interfaces.
#pragma once

#include "core/vec.h"

namespace relume {

RELUME_HD inline float pow5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

/// [Schlick94]: from `f0` at normal incidence to `f90` at grazing angles.
RELUME_HD inline Rgb fresnel_schlick(const Rgb& f0, const Rgb& f90, float cos_theta) {
  return f0 + (f90 - f0) * pow5(saturate(1.0f - cos_theta));
}

/// Unpolarised reflectance of a dielectric. `cos_i` ≥ 0 on the incident side; `eta`: index of the far side over that of
/// the near side. 1 in total internal reflection.
RELUME_HD inline float fresnel_dielectric(float cos_i, float eta) {
  const float sin2_t = (1.0f - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1.0f) return 1.0f;
  const float cos_t = safe_sqrt(1.0f - sin2_t);
  const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// Reflectance at normal incidence.
RELUME_HD inline float f0_from_ior(float ior) { return sqr((ior - 1.0f) / (ior + 1.0f)); }

/// Direction of the refracted ray for unit `wo` and unit `m` with wo·m > 0. Returns false in total internal reflection.
RELUME_HD inline bool refract(const Vec3& wo, const Vec3& m, float eta, Vec3* wi) {
  const float cos_o = glm::dot(wo, m);
  const float sin2_t = (1.0f - cos_o * cos_o) / (eta * eta);
  if (sin2_t >= 1.0f) return false;
  *wi = -wo / eta + (cos_o / eta - safe_sqrt(1.0f - sin2_t)) * m;
  return true;
}

RELUME_HD inline Vec3 reflect(const Vec3& wo, const Vec3& m) { return 2.0f * glm::dot(wo, m) * m - wo; }

}  // namespace relume
