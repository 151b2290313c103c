// Sheen: reflection off fibres of cloth, mostly at grazing angles ([Estevez17], KHR_materials_sheen).
#pragma once

#include "materials/lobes/lobe.h"
#include "sampling/warp.h"

namespace relume::sheen {

/// Uniform density over the hemisphere. The lobe is broad and peaks at the horizon, where cosine sampling fails.
RELUME_HD inline float hemisphere_pdf() { return 0.5f * kInvPi; }

/// Value of the sheen. If fibres would return more than all light, it is divided by the larger albedo of both
/// directions, which keeps it reciprocal. lobe.alpha: that of the fibres.
RELUME_HD_NOINLINE inline LobeEval eval(const Lobe& lobe, const EnergyTables& tables, const Vec3& wo, const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  const float alpha = lobe.alpha;
  const float cos_m = glm::normalize(wo + wi).z;
  const float albedo = relume::max(tables.sheen.directional(wo.z, alpha), tables.sheen.directional(wi.z, alpha));
  return {lobe.color * (value(cos_m, wo.z, wi.z, alpha) / relume::max(albedo, 1.0f)), hemisphere_pdf()};
}

RELUME_HD inline LobeSample sample(const Vec2& u) {
  const Vec3 wi = cone_from_square(u, 1.0f);
  return {wi, Rgb(0), wi.z > 0.0f};
}

/// Albedo of the fibres at `cos_theta` without lobe.color, at most 1. An upper bound where eval() reduces the value.
RELUME_HD_NOINLINE inline float albedo(const Lobe& lobe, const EnergyTables& tables, float cos_theta) {
  return relume::min(tables.sheen.directional(std::fabs(cos_theta), lobe.alpha), 1.0f);
}

}  // namespace relume::sheen
