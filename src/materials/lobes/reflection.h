// Reflection off microfacets: single and multiple scattering, and the delta limit.
#pragma once

#include "materials/lobes/lobe.h"

namespace relume::reflection {

/// Evaluates reflection off anisotropic microfacets with normal `m`.
RELUME_HD_NOINLINE inline LobeEval eval_anisotropic(const AnisotropicGgx& mf, const Rgb& reflected, const Vec3& wo,
                                                    const Vec3& wi, const Vec3& m) {
  return {reflected * (mf.d(m) * mf.g2(wo, wi) / (4.0f * wo.z * wi.z)), mf.pdf(wo, m) / (4.0f * glm::dot(wo, m))};
}

/// f = F D G2 / (4 cos θo cos θi) ([Walter07], eq. 20).
template <bool kLayered>
RELUME_HD inline LobeEval eval(const Lobe& lobe, const InterfaceDetail& detail, const Vec3& wo, const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  const Vec3 m = glm::normalize(wo + wi);
  const float cos_om = glm::dot(wo, m);
  const Rgb reflected = fresnel<kLayered>(lobe, detail, cos_om);
  if (kLayered && lobe.anisotropic) return eval_anisotropic(detail.anisotropy, reflected, wo, wi, m);
  const Microfacet mf = lobe.microfacet();
  const float d = mf.d(m);
  const Rgb f = reflected * (d * mf.g2(wo, wi) / (4.0f * wo.z * wi.z));
  const float pdf_m = mf.model == MicrofacetModel::ggx ? mf.g1(wo) * cos_om * d / wo.z : d * m.z;
  return {f, pdf_m / (4.0f * cos_om)};
}

template <bool kLayered>
RELUME_HD inline LobeSample sample(const Lobe& lobe, const InterfaceDetail& detail, const Vec3& wo, const Vec2& u) {
  const Vec3 m = kLayered && lobe.anisotropic ? detail.anisotropy.sample(wo, u) : lobe.microfacet().sample(wo, u);
  const Vec3 wi = reflect(wo, m);
  return {wi, Rgb(0), wi.z > 0.0f && glm::dot(wo, m) > 0.0f};
}

/// Albedo under Schlick's Fresnel.
RELUME_HD inline Rgb albedo(const Lobe& lobe, const EnergyTable& table, float cos_theta) {
  const EnergyShares e = table.directional_shares(cos_theta, std::sqrt(lobe.alpha));
  return lobe.color * (e.total - e.grazing) + lobe.f90 * e.grazing;
}

}  // namespace relume::reflection

namespace relume::multiple_reflection {

/// F_ms: colour of light after two or more reflections between microfacets ([Kulla17]); 1 for a lossless mirror.
RELUME_HD inline Rgb color(const Rgb& f0, const Rgb& f90, float average_albedo) {
  const Rgb f_avg = f0 + (f90 - f0) * (1.0f / 21.0f);
  return f_avg * f_avg * average_albedo / (Rgb(1) - f_avg * (1.0f - average_albedo));
}

RELUME_HD_NOINLINE inline LobeEval eval_anisotropic(const Lobe& lobe, const AnisotropicGgx& mf,
                                                    const EnergyTables& tables, const Vec3& wo, const Vec3& wi) {
  const float missing_o = 1.0f - tables.anisotropic.directional_shares(mf, wo).total;
  const float missing_i = 1.0f - tables.anisotropic.directional_shares(mf, wi).total;
  const float missing_avg = 1.0f - tables.anisotropic.average_shares(mf).total;
  return {lobe.color * (kInvPi * missing_o * missing_i / missing_avg), cosine_hemisphere_pdf(wi.z)};
}

/// f = F_ms (1 − E(wo)) (1 − E(wi)) / (π (1 − E_avg)).
template <bool kLayered>
RELUME_HD inline LobeEval eval(const Lobe& lobe, const InterfaceDetail& detail, const EnergyTables& tables,
                               const Vec3& wo, const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  if (kLayered && lobe.anisotropic) return eval_anisotropic(lobe, detail.anisotropy, tables, wo, wi);
  const EnergyTable& table = tables.of(lobe.model);
  const float r = std::sqrt(lobe.alpha);
  const float missing_o = 1.0f - table.directional_shares(wo.z, r).total;
  const float missing_i = 1.0f - table.directional_shares(wi.z, r).total;
  const float missing_avg = 1.0f - table.average_shares(r).total;
  return {lobe.color * (kInvPi * missing_o * missing_i / missing_avg), cosine_hemisphere_pdf(wi.z)};
}

RELUME_HD inline Rgb albedo(const Lobe& lobe, const EnergyTable& table, float cos_theta) {
  return lobe.color * (1.0f - table.directional_shares(cos_theta, std::sqrt(lobe.alpha)).total);
}

}  // namespace relume::multiple_reflection

namespace relume::specular_reflection {

template <bool kLayered>
RELUME_HD inline LobeSample sample(const Lobe& lobe, const InterfaceDetail& detail, const Vec3& wo) {
  return {{-wo.x, -wo.y, wo.z}, fresnel<kLayered>(lobe, detail, wo.z), true};
}

}  // namespace relume::specular_reflection
