// A clearcoat with a normal other than that of its base (KHR_materials_clearcoat). A coat has isotropic microfacets and
// no film, so it uses the functions of lobes without layers: they have no calls that take memory of a device's thread.
#pragma once

#include "core/frame.h"
#include "materials/lobes/reflection.h"

namespace relume::coat_with_normal {

/// Ratio of the cosine on the coat to the larger of the cosines on coat and surface. Dividing by the larger of the two
/// keeps the coat reciprocal, and it never returns more than in its own frame.
RELUME_HD inline float cosine_ratio(float cos_coat, float cos_surface) {
  return cos_coat / relume::max(cos_coat, cos_surface);
}

RELUME_HD_NOINLINE inline LobeEval eval(const Lobe& lobe, const InterfaceDetail& detail, const Vec3& wo,
                                        const Vec3& wi) {
  if (wi.z <= 0.0f) return {};
  const Frame frame = make_frame(detail.coat_normal);
  const Vec3 o = frame.to_local(wo);
  const Vec3 i = frame.to_local(wi);
  if (o.z <= 0.0f || i.z <= 0.0f) return {};
  LobeEval e = reflection::eval<false>(lobe, detail, o, i);
  e.f *= cosine_ratio(o.z, wo.z) * cosine_ratio(i.z, wi.z);
  return e;
}

RELUME_HD_NOINLINE inline LobeSample sample(const Lobe& lobe, const InterfaceDetail& detail, const Vec3& wo,
                                            const Vec2& u) {
  const Frame frame = make_frame(detail.coat_normal);
  const Vec3 o = frame.to_local(wo);
  if (o.z <= 0.0f) return {};
  if (lobe.kind != LobeKind::specular_reflection) {
    LobeSample s = reflection::sample<false>(lobe, detail, o, u);
    s.wi = frame.to_world(s.wi);
    s.valid = s.valid && s.wi.z > 0.0f;
    return s;
  }
  const Vec3 wi = reflect(wo, detail.coat_normal);
  if (wi.z <= 0.0f) return {};
  // f cos θ, with the cosine of the surface instead of the coat.
  const float share = cosine_ratio(o.z, wo.z) * wi.z / relume::max(o.z, wi.z);
  return {wi, fresnel<false>(lobe, detail, o.z) * share, true};
}

}  // namespace relume::coat_with_normal
