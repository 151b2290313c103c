// Interface of a transparent medium: reflection and refraction, rough ([Walter07]) or smooth.
#pragma once

#include "materials/lobes/lobe.h"

namespace relume::dielectric {

/// Reflectance at `cos_i`: exact for interface.f0 = f0_from_ior(η) and interface.f90 = 1. KHR_materials_specular may
/// lower both; the curve is then scaled to run between them. Total internal reflection stays total.
RELUME_HD inline Rgb reflectance(const Interface& interface, float cos_i) {
  const float exact = fresnel_dielectric(cos_i, interface.eta);
  if (exact >= 1.0f) return Rgb(1);
  const float f0 = f0_from_ior(interface.eta);
  return interface.f0 + (interface.f90 - interface.f0) * saturate((exact - f0) / (1.0f - f0));
}

/// The same with a possible film on the outside, for both directions of light.
template <bool kLayered>
RELUME_HD inline Rgb reflectance(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                 float cos_i) {
  if (!kLayered || lobe.film == FilmBase::none) return reflectance(interface, cos_i);
  if (interface.eta >= 1.0f) return film_reflectance(detail.film, lobe.film, cos_i);
  const float sin2_outside = (1.0f - cos_i * cos_i) / (interface.eta * interface.eta);
  if (sin2_outside >= 1.0f) return Rgb(1);
  return film_reflectance(detail.film, lobe.film, safe_sqrt(1.0f - sin2_outside));
}

/// Probability of choosing reflection: its share of the light, if the tint absorbed nothing.
RELUME_HD inline float reflection_probability(const Rgb& reflectance) { return saturate(luminance(reflectance)); }

template <bool kLayered>
RELUME_HD inline LobeEval eval_reflection(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                          const Vec3& wo, const Vec3& wi) {
  const Microfacet mf = lobe.microfacet();
  const Vec3 m = glm::normalize(wo + wi);
  const float cos_om = glm::dot(wo, m);
  if (cos_om <= 0.0f) return {};
  const Rgb reflected = reflectance<kLayered>(lobe, interface, detail, cos_om);
  const float f = mf.d(m) * mf.g2(wo, wi) / (4.0f * wo.z * wi.z);
  return {reflected * f, reflection_probability(reflected) * mf.pdf(wo, m) / (4.0f * cos_om)};
}

/// Refraction ([Walter07], eq. 21 and 17).
template <bool kLayered>
RELUME_HD inline LobeEval eval_refraction(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                          const Vec3& wo, const Vec3& wi, TransportMode mode) {
  const Microfacet mf = lobe.microfacet();
  Vec3 m = wo + interface.eta * wi;
  if (length_squared(m) < 1e-12f) return {};
  m = glm::normalize(m);
  if (m.z < 0.0f) m = -m;
  const float cos_om = glm::dot(wo, m);
  const float cos_im = glm::dot(wi, m);
  if (cos_om <= 0.0f || cos_im >= 0.0f) return {};
  const Rgb reflected = reflectance<kLayered>(lobe, interface, detail, cos_om);
  const float chosen = 1.0f - reflection_probability(reflected);
  const float jacobian_i = -cos_im * interface.eta * interface.eta / sqr(cos_om + interface.eta * cos_im);
  const Vec3 wi_up(wi.x, wi.y, -wi.z);
  const float f = mf.d(m) * mf.g2(wo, wi_up) * cos_om * jacobian_i / (wo.z * wi_up.z);
  const Rgb transmitted = lobe.color * (Rgb(1) - reflected);
  return {transmitted * (f * transport_scale(interface.eta, mode)), chosen * mf.pdf(wo, m) * jacobian_i};
}

template <bool kLayered>
RELUME_HD inline LobeEval eval(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                               const Vec3& wo, const Vec3& wi, TransportMode mode) {
  if (wi.z == 0.0f) return {};
  return wi.z > 0.0f ? eval_reflection<kLayered>(lobe, interface, detail, wo, wi)
                     : eval_refraction<kLayered>(lobe, interface, detail, wo, wi, mode);
}

template <bool kLayered>
RELUME_HD inline LobeSample sample(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                   const Vec3& wo, float u_side, const Vec2& u) {
  const Vec3 m = lobe.microfacet().sample(wo, u);
  const float cos_om = glm::dot(wo, m);
  if (cos_om <= 0.0f) return {};
  if (u_side < reflection_probability(reflectance<kLayered>(lobe, interface, detail, cos_om))) {
    const Vec3 wi = reflect(wo, m);
    return {wi, Rgb(0), wi.z > 0.0f};
  }
  Vec3 wi;
  if (!refract(wo, m, interface.eta, &wi)) return {};
  return {wi, Rgb(0), wi.z < 0.0f};
}

}  // namespace relume::dielectric

namespace relume::smooth_dielectric {

template <bool kLayered>
RELUME_HD inline LobeSample sample(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                   const Vec3& wo, float u_side, TransportMode mode) {
  const Vec3 n(0, 0, 1);
  const Rgb reflected = dielectric::reflectance<kLayered>(lobe, interface, detail, wo.z);
  const float p = dielectric::reflection_probability(reflected);
  if (u_side < p) return {{-wo.x, -wo.y, wo.z}, reflected / p, true};
  Vec3 wi;
  if (!refract(wo, n, interface.eta, &wi)) return {};
  const Rgb transmitted = lobe.color * (Rgb(1) - reflected) / (1.0f - p);
  return {wi, transmitted * transport_scale(interface.eta, mode), true};
}

}  // namespace relume::smooth_dielectric
