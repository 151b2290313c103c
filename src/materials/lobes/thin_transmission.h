// Transmission through a wall too thin to refract (KHR_materials_transmission without a volume). The unreflected light
// is spread by the roughness as in reflection, and mirrored to the far side.
#pragma once

#include "materials/lobes/lobe.h"

namespace relume::thin_transmission {

template <bool kLayered>
RELUME_HD inline LobeEval eval(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                               const Vec3& wo, const Vec3& wi) {
  if (wi.z >= 0.0f) return {};
  const Vec3 wi_up(wi.x, wi.y, -wi.z);
  const Vec3 m = glm::normalize(wo + wi_up);
  const float cos_om = glm::dot(wo, m);
  const Microfacet mf = lobe.microfacet();
  const Rgb transmitted = lobe.color * (Rgb(1) - fresnel<kLayered>(lobe, interface, detail, cos_om));
  const float f = mf.d(m) * mf.g2(wo, wi_up) / (4.0f * wo.z * wi_up.z);
  return {transmitted * f, mf.pdf(wo, m) / (4.0f * cos_om)};
}

RELUME_HD inline LobeSample sample(const Lobe& lobe, const Vec3& wo, const Vec2& u) {
  const Vec3 m = lobe.microfacet().sample(wo, u);
  const Vec3 wi = reflect(wo, m);
  return {{wi.x, wi.y, -wi.z}, Rgb(0), wi.z > 0.0f && glm::dot(wo, m) > 0.0f};
}

}  // namespace relume::thin_transmission

namespace relume::null_transmission {

template <bool kLayered>
RELUME_HD inline LobeSample sample(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                                   const Vec3& wo) {
  return {-wo, lobe.color * (Rgb(1) - fresnel<kLayered>(lobe, interface, detail, wo.z)), true};
}

}  // namespace relume::null_transmission
