// Diffuse reflection, bare or below a dielectric interface, and diffuse transmission through a thin sheet.
#pragma once

#include "materials/lobes/lobe.h"
#include "sampling/warp.h"

namespace relume::lambert {

/// f = ρ / π.
RELUME_HD inline LobeEval eval(const Lobe& lobe, const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  return {lobe.color * kInvPi, cosine_hemisphere_pdf(wi.z)};
}

RELUME_HD inline LobeSample sample(const Vec2& u) { return {cosine_hemisphere_from_square(u), Rgb(0), true}; }

}  // namespace relume::lambert

namespace relume::covered_lambert {

/// Directional albedo of the interface.
RELUME_HD inline Rgb interface_albedo(const Interface& interface, const EnergyShares& shares) {
  return interface.f0 * (shares.total - shares.grazing) + interface.f90 * shares.grazing;
}

/// Transmittance of the interface for direction `cos_theta`.
RELUME_HD inline Rgb transmitted(const Lobe& lobe, const Interface& interface, const EnergyTable& table,
                                 float cos_theta) {
  const float r = std::sqrt(lobe.alpha);
  return Rgb(1) - interface_albedo(interface, table.directional_shares(cos_theta, r));
}

/// Value of diffuse reflection below an interface. `through_o`, `through_i`: transmittance along wo and wi; `average`:
/// transmittance of uniform illumination.
RELUME_HD inline LobeEval below(const Lobe& lobe, const Rgb& through_o, const Rgb& through_i, const Rgb& average,
                                float cos_i) {
  Rgb f = lobe.color * kInvPi * through_o * through_i;
  for (int c = 0; c < 3; ++c) f[c] = average[c] > 0.0f ? f[c] / average[c] : 0.0f;  // below a perfect mirror
  return {f, cosine_hemisphere_pdf(cos_i)};
}

RELUME_HD_NOINLINE inline LobeEval eval_anisotropic(const Lobe& lobe, const Interface& interface,
                                                    const AnisotropicGgx& mf, const EnergyTables& tables,
                                                    const Vec3& wo, const Vec3& wi) {
  const auto through = [&](const EnergyShares& shares) { return Rgb(1) - interface_albedo(interface, shares); };
  return below(lobe, through(tables.anisotropic.directional_shares(mf, wo)),
               through(tables.anisotropic.directional_shares(mf, wi)), through(tables.anisotropic.average_shares(mf)),
               wi.z);
}

/// f = ρ/π · (1 − E(wo)) (1 − E(wi)) / (1 − E_avg). Reciprocal. For ρ = 1, interface and base reflect all light
/// ([Kulla17], the energy-conserving diffuse).
template <bool kLayered>
RELUME_HD inline LobeEval eval(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                               const EnergyTables& tables, const Vec3& wo, const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  if (kLayered && lobe.anisotropic) return eval_anisotropic(lobe, interface, detail.anisotropy, tables, wo, wi);
  const EnergyTable& table = tables.of(lobe.model);
  const Rgb average = Rgb(1) - interface_albedo(interface, table.average_shares(std::sqrt(lobe.alpha)));
  return below(lobe, transmitted(lobe, interface, table, wo.z), transmitted(lobe, interface, table, wi.z), average,
               wi.z);
}

}  // namespace relume::covered_lambert

namespace relume::diffuse_transmission {

/// Share of light that passes. From inside a medium, the share 1 − η² is reflected diffusely. The hemisphere outside
/// can take no more than η² of a Lambertian distribution, so only this is reciprocal ([Veach97], eq. 5.14).
RELUME_HD inline float passing_share(const Interface& interface) { return relume::min(sqr(interface.eta), 1.0f); }

/// Value of covered_lambert times the share of each side; both sides have the interface. Transmitted light is scaled
/// like refraction. Light that enters one way and leaves the other is therefore neither gained nor lost.
RELUME_HD_NOINLINE inline LobeEval eval(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                        const EnergyTables& tables, const Vec3& wo, const Vec3& wi,
                                        TransportMode mode) {
  const bool passes = wi.z < 0.0f;
  const float share = passes ? passing_share(interface) : 1.0f - passing_share(interface);
  LobeEval e = covered_lambert::eval<true>(lobe, interface, detail, tables, wo, {wi.x, wi.y, std::fabs(wi.z)});
  e.f *= passes ? share * transport_scale(interface.eta, mode) : share;
  e.pdf_w *= share;
  return e;
}

RELUME_HD inline LobeSample sample(const Interface& interface, float u_side, const Vec2& u) {
  const Vec3 up = cosine_hemisphere_from_square(u);
  return {{up.x, up.y, u_side < passing_share(interface) ? -up.z : up.z}, Rgb(0), true};
}

}  // namespace relume::diffuse_transmission
