// Isotropic microfacet distributions in the local frame (+Z is the macroscopic normal): GGX with visible normals and
// Beckmann, both with height-correlated Smith masking-shadowing ([Heitz14]).
#pragma once

#include "core/math.h"
#include "core/vec.h"
#include "relume/material_types.h"
#include "sampling/warp.h"

namespace relume {

/// Surfaces of lower α are perfectly smooth, with delta lobes.
inline constexpr float kMinAlpha = 1e-3f;

/// Root of the fit of Beckmann's Λ as a function of 1/(α tan θ). [Walter07] ends the fit at 1.6, beyond the root, where
/// Λ is slightly negative.
inline constexpr float kBeckmannLambdaEnd = 1.548f;

struct Microfacet {
  MicrofacetModel model;
  float alpha;  ///< roughness, (0, 1]

  RELUME_HD bool smooth() const { return alpha < kMinAlpha; }

  /// Density of microfacet normals per projected area: ∫ D(m) cos θ_m dm = 1.
  RELUME_HD float d(const Vec3& m) const {
    if (m.z <= 0.0f) return 0.0f;
    const float a2 = alpha * alpha;
    const float c2 = m.z * m.z;
    const float tan2 = (m.x * m.x + m.y * m.y) / c2;
    if (model == MicrofacetModel::ggx) return a2 / (kPi * sqr(c2 * (a2 + tan2)));
    return math::exp(-tan2 / a2) / (kPi * a2 * c2 * c2);
  }

  /// Smith's Λ ([Heitz14], eq. 72 for GGX; the rational fit of [Walter07] for Beckmann).
  RELUME_HD float lambda(const Vec3& w) const {
    const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    if (!is_finite(tan2)) return kInfinity;
    if (model == MicrofacetModel::ggx) return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
    const float a = 1.0f / (alpha * std::sqrt(tan2));
    if (!(a < kBeckmannLambdaEnd)) return 0.0f;
    return (1.0f - 1.259f * a + 0.396f * a * a) / (3.535f * a + 2.181f * a * a);
  }

  RELUME_HD float g1(const Vec3& w) const { return 1.0f / (1.0f + lambda(w)); }
  /// Height-correlated masking-shadowing of two directions on the same side.
  RELUME_HD float g2(const Vec3& wo, const Vec3& wi) const { return 1.0f / (1.0f + lambda(wo) + lambda(wi)); }

  /// Samples a normal for `wo` (z > 0): visible normals for GGX ([Dupuy23]), all normals for Beckmann.
  RELUME_HD Vec3 sample(const Vec3& wo, const Vec2& u) const {
    return model == MicrofacetModel::ggx ? sample_ggx(wo, u) : sample_beckmann(u);
  }

  /// Density of sample(), per solid angle.
  RELUME_HD float pdf(const Vec3& wo, const Vec3& m) const {
    if (model == MicrofacetModel::ggx) return g1(wo) * relume::max(0.0f, glm::dot(wo, m)) * d(m) / wo.z;
    return d(m) * m.z;
  }

 private:
  /// Visible normals of GGX are those of a hemisphere seen from the stretched direction. There they are half vectors
  /// towards a uniformly sampled spherical cap.
  RELUME_HD Vec3 sample_ggx(const Vec3& wo, const Vec2& u) const {
    const Vec3 wo_std = glm::normalize(Vec3(wo.x * alpha, wo.y * alpha, wo.z));
    const float z = (1.0f - u.y) * (1.0f + wo_std.z) - wo_std.z;
    const float r = safe_sqrt(1.0f - z * z);
    const Vec3 m_std = Vec3(r * math::unit_vector(2.0f * kPi * u.x), z) + wo_std;
    return glm::normalize(Vec3(m_std.x * alpha, m_std.y * alpha, relume::max(m_std.z, 1e-7f)));
  }

  RELUME_HD Vec3 sample_beckmann(const Vec2& u) const {
    const float tan2 = -alpha * alpha * math::log(1.0f - u.y);
    const float z = 1.0f / std::sqrt(1.0f + tan2);
    const float r = z * std::sqrt(tan2);  // 1 − z² cancels at small α
    return {r * math::unit_vector(2.0f * kPi * u.x), z};
  }
};

}  // namespace relume
