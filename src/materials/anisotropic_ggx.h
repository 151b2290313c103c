// Anisotropic GGX in the local frame of microfacet.h ([Heitz14], §5.3), as of brushed metal, hair and satin.
#pragma once

#include "materials/microfacet.h"

namespace relume {

struct AnisotropicGgx {
  float alpha_t;   ///< along the tangent
  float alpha_b;   ///< perpendicular to the tangent
  float strength;  ///< alpha_t = lerp(alpha_b, 1, strength²), as in KHR_materials_anisotropy
  Vec2 tangent;    ///< unit, in the x-y plane of the local frame; the sign is irrelevant

  RELUME_HD Vec3 to_tangent(const Vec3& w) const {
    return {w.x * tangent.x + w.y * tangent.y, w.y * tangent.x - w.x * tangent.y, w.z};
  }
  RELUME_HD Vec3 from_tangent(const Vec3& w) const {
    return {w.x * tangent.x - w.y * tangent.y, w.x * tangent.y + w.y * tangent.x, w.z};
  }

  /// Density of normals, as Microfacet::d().
  RELUME_HD float d(const Vec3& m) const {
    if (m.z <= 0.0f) return 0.0f;
    const Vec3 t = to_tangent(m);
    return 1.0f / (kPi * alpha_t * alpha_b * sqr(sqr(t.x / alpha_t) + sqr(t.y / alpha_b) + t.z * t.z));
  }

  /// Smith's Λ.
  RELUME_HD float lambda(const Vec3& w) const {
    const Vec3 t = to_tangent(w);
    const float tan2 = (sqr(alpha_t * t.x) + sqr(alpha_b * t.y)) / (t.z * t.z);
    return is_finite(tan2) ? 0.5f * (std::sqrt(1.0f + tan2) - 1.0f) : kInfinity;
  }

  RELUME_HD float g1(const Vec3& w) const { return 1.0f / (1.0f + lambda(w)); }
  /// Height-correlated masking-shadowing of two directions on the same side.
  RELUME_HD float g2(const Vec3& wo, const Vec3& wi) const { return 1.0f / (1.0f + lambda(wo) + lambda(wi)); }

  /// Samples a normal visible from `wo` (z > 0): an isotropic one of α = 1 in the stretched space ([Dupuy23]).
  RELUME_HD_NOINLINE Vec3 sample(const Vec3& wo, const Vec2& u) const {
    const Vec3 t = to_tangent(wo);
    const Vec3 stretched = glm::normalize(Vec3(t.x * alpha_t, t.y * alpha_b, t.z));
    const Vec3 m = Microfacet{MicrofacetModel::ggx, 1.0f}.sample(stretched, u);
    return from_tangent(glm::normalize(Vec3(m.x * alpha_t, m.y * alpha_b, m.z)));
  }

  /// Density of sample(), per solid angle.
  RELUME_HD float pdf(const Vec3& wo, const Vec3& m) const {
    return g1(wo) * relume::max(0.0f, glm::dot(wo, m)) * d(m) / wo.z;
  }
};

}  // namespace relume
