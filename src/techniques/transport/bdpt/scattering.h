// Scattering for both directions of transport. Paths from the camera define the image. Where scattering depends on
// which of the two directions is the viewer's, light subpaths therefore use the camera's side.
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// Whether the shading frame is bent because the viewer is below the horizon of the shading normal.
RELUME_HD inline bool bent(const SurfacePoint& sp) { return glm::dot(sp.ns, sp.wo) < kMinShadingCosine; }

/// Whether viewers along sp.wo and along `w` have the same shading frame. If one of them bends it, only camera subpaths
/// scatter there.
RELUME_HD inline bool same_shading_frame(const SurfacePoint& sp, const Vec3& w) {
  if (bent(sp)) return false;
  const float cosine = glm::dot(sp.ns, w);
  return (glm::dot(sp.ng, w) < 0.0f ? -cosine : cosine) >= kMinShadingCosine;
}

/// Density with which a subpath arriving along −w continues along sp.wo.
RELUME_HD inline float other_sides_pdf(const SurfacePoint& sp, const Vec3& w) {
  if (!same_shading_frame(sp, w)) return 0.0f;
  const Vec3 local = sp.frame.to_local(w);
  if (is_lambert(sp.bsdf)) return local.z > 0.0f ? cosine_hemisphere_pdf(sp.wo_local.z) : 0.0f;
  return reverse_pdf(sp.bsdf, sp.wo_local, local);
}

/// Density of delta scattering from w to sp.wo over that from sp.wo to w. `w` is sampled from a delta lobe.
RELUME_HD inline float delta_density_ratio(const SurfacePoint& sp, const Vec3& w) {
  if (!same_shading_frame(sp, w)) return 0.0f;
  const Vec3 local = sp.frame.to_local(w);
  const bool own_normal = sp.bsdf.layered && sp.bsdf.coat_has_normal;
  // Reflection: the angles are equal, so all factors are equal.
  if (local.z > 0.0f && !own_normal) return 1.0f;
  float probabilities[kMaxLobes];
  if (local.z > 0.0f) {
    // Either the base or the coat reflected. The angles to the base normal are equal only for the base.
    const Vec3 mirrored(-sp.wo_local.x, -sp.wo_local.y, sp.wo_local.z);
    const Vec3 by_coat = reflect(sp.wo_local, sp.bsdf.detail.coat_normal);
    if (length_squared(local - mirrored) < length_squared(local - by_coat)) return 1.0f;
    if (!lobe_probabilities(sp.bsdf, local.z, Side::same, probabilities)) return 0.0f;
    return probabilities[0] / sp.bsdf.lobes[0].probability;
  }
  if (!lobe_probabilities(sp.bsdf, -local.z, Side::other, probabilities)) return 0.0f;
  for (int i = 0; i < sp.bsdf.lobe_count; ++i) {
    const Lobe& lobe = sp.bsdf.lobes[i];
    if (!is_delta(lobe.kind) || !transmits(lobe.kind)) continue;
    // Refraction scales solid angles by η² cos θ from one side to the other ([Veach97], §5.2).
    const float jacobian = sp.wo_local.z / (sqr(sp.bsdf.interface.eta) * -local.z);
    return probabilities[i] / lobe.probability * jacobian;
  }
  return 0.0f;
}

/// Transforms the directions stored in a BSDF between two local frames.
RELUME_HD inline void transform_to_frame(Bsdf& bsdf, const Frame& from, const Frame& to) {
  if (!bsdf.layered) return;
  if (bsdf.coat_has_normal) {
    const float side = glm::dot(from.n, to.n) < 0.0f ? -1.0f : 1.0f;
    bsdf.detail.coat_normal = to.to_local(from.to_world(bsdf.detail.coat_normal)) * side;
  }
  bool anisotropic = false;
  for (int i = 0; i < bsdf.lobe_count; ++i) anisotropic = anisotropic || bsdf.lobes[i].anisotropic;
  if (!anisotropic) return;
  Vec2& tangent = bsdf.detail.anisotropy.tangent;
  const Vec3 along = to.to_local(from.to_world({tangent.x, tangent.y, 0.0f}));
  const float length = std::sqrt(along.x * along.x + along.y * along.y);
  if (length > 0.0f) tangent = {along.x / length, along.y / length};
}

/// Changes the viewer of a surface.
RELUME_HD inline void view_from(SurfacePoint& sp, const Vec3& wo) {
  sp.wo = wo;
  if (glm::dot(sp.ng, wo) < 0.0f) {
    sp.ng = -sp.ng;
    sp.ns = -sp.ns;
    sp.front_face = !sp.front_face;
    flip(sp.bsdf.interface);
  }
  const Frame before = sp.frame;
  sp.frame = make_frame(surface_detail::visible_shading_normal(sp.ns, sp.ng, wo));
  sp.wo_local = sp.frame.to_local(wo);
  transform_to_frame(sp.bsdf, before, sp.frame);
  prepare(sp.bsdf, sp.wo_local.z);
}

/// Scattering at a vertex of a light subpath, towards the camera's side.
struct AdjointEval {
  Rgb f{0};             ///< BSDF times |ns · light| / |ng · light| ([Veach97], §5.3), as seen from the camera's side
  float pdf_light = 0;  ///< density of this direction for the light subpath, per solid angle
  float pdf_camera = 0;  ///< density of the light's direction for a camera subpath, per solid angle
};

/// eval_adjoint() where both viewers have the same shading frame.
RELUME_HD inline AdjointEval eval_in_same_frame(const SurfacePoint& sp, const Vec3& w) {
  const BsdfEval e = eval_pdf<true>(sp, w, TransportMode::importance);
  return {e.f * (sp.wo_local.z / glm::dot(sp.ng, sp.wo)), e.pdf_forward, e.pdf_reverse};
}

/// eval_adjoint() for a surface that is used for nothing more: it is then seen from the camera's side.
RELUME_HD inline AdjointEval eval_last_adjoint(SurfacePoint& sp, const Vec3& w) {
  if (same_shading_frame(sp, w)) return eval_in_same_frame(sp, w);
  const Vec3 light = sp.wo;
  const float cos_geometric = glm::dot(sp.ng, light);
  view_from(sp, w);
  const BsdfEval e = eval_pdf(sp, light);
  return {e.f * (shading_cosine(sp, light) / cos_geometric), 0.0f, e.pdf_forward};
}

/// `sp` is seen from the light; `w` points to the camera's side.
RELUME_HD inline AdjointEval eval_adjoint(const SurfacePoint& sp, const Vec3& w) {
  if (same_shading_frame(sp, w)) return eval_in_same_frame(sp, w);
  SurfacePoint copy = sp;
  return eval_last_adjoint(copy, w);
}

/// Throughput factor for light that arrived along −sp.wo and leaves along `w` ([Veach97], §5.3).
RELUME_HD inline float adjoint_correction(const SurfacePoint& sp, const Vec3& w) {
  return sp.wo_local.z * std::fabs(glm::dot(sp.ng, w)) / (glm::dot(sp.ng, sp.wo) * shading_cosine(sp, w));
}

}  // namespace relume
