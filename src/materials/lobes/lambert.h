// Diffuse reflection, bare or below a dielectric interface.
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

/// Directional albedo of the cover.
RELUME_HD inline Rgb cover_albedo(const Lobe& lobe, const EnergyShares& shares) {
  return lobe.f0 * (shares.total - shares.grazing) + lobe.f90 * shares.grazing;
}

/// The share of light that gets through the cover from direction `cos_theta`.
RELUME_HD inline Rgb transmitted(const Lobe& lobe, const EnergyTable& table, float cos_theta) {
  const float r = std::sqrt(lobe.microfacet.alpha);
  return Rgb(1) - cover_albedo(lobe, table.directional_shares(cos_theta, r));
}

/// f = ρ/π · (1 − E(wo)) (1 − E(wi)) / (1 − E_avg): reciprocal, and cover plus base reflect all light if ρ = 1
/// ([Kulla17], the energy-conserving diffuse).
RELUME_HD inline LobeEval eval(const Lobe& lobe, const EnergyTable& table, const Vec3& wo, const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  const Rgb average = Rgb(1) - cover_albedo(lobe, table.average_shares(std::sqrt(lobe.microfacet.alpha)));
  Rgb f = lobe.color * kInvPi * transmitted(lobe, table, wo.z) * transmitted(lobe, table, wi.z);
  for (int c = 0; c < 3; ++c) f[c] = average[c] > 0.0f ? f[c] / average[c] : 0.0f;  // below a perfect mirror
  return {f, cosine_hemisphere_pdf(wi.z)};
}

}  // namespace relume::covered_lambert
