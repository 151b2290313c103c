// Compact vertex of a light subpath, kept for connections.
#pragma once

#include "scene/dispersion.h"
#include "techniques/transport/bdpt/partial_weights.h"
#include "techniques/transport/bdpt/scattering.h"

namespace relume {

/// Maximum number of vertices of a light subpath, including that on the light. The camera samples longer paths.
inline constexpr uint32_t kMaxLightVertices = 32;

/// Lambert surfaces, by far the most frequent, store all data of a connection. Others are looked up again from the hit.
/// Members have no defaults, because a subpath has many vertices.
struct PathVertex {
  Vec3 position;
  Vec3 ng;         ///< geometric normal on the side of wo
  Vec3 ns;         ///< shading normal on the side of wo
  Vec3 wo;         ///< to the previous vertex
  Rgb throughput;  ///< of the arriving light; black: no connections here
  Rgb albedo;      ///< of a Lambert surface; negative: another kind
  PartialWeights weights;
  uint32_t instance : 30;   ///< 2³⁰ instances would need 150 GiB
  uint32_t dispersion : 2;  ///< Dispersion of the surface; always: the subpath has scattered by wavelength
  uint32_t primitive;
  Vec2 barycentric;

  RELUME_HD bool connectable() const { return !is_black(throughput); }
  /// Whether the light that leaves along `w` depends on the wavelength.
  RELUME_HD bool disperses(const Vec3& w) const {
    return relume::disperses(static_cast<Dispersion>(dispersion), glm::dot(ng, w));
  }
};
static_assert(sizeof(PathVertex) <= 96);

RELUME_HD inline PathVertex make_path_vertex(const SurfacePoint& sp, const Rgb& throughput,
                                             const PartialWeights& weights, Dispersion dispersion) {
  PathVertex v;
  v.throughput = has_non_delta(sp.bsdf) ? throughput : Rgb(0);
  v.position = sp.position;
  v.ng = sp.ng;
  v.ns = sp.ns;
  v.wo = sp.wo;
  const bool plain = is_lambert(sp.bsdf) && !bent(sp);  // bent frames depend on the view and are looked up
  v.albedo = plain ? sp.bsdf.lobes[0].color : Rgb(-1);
  v.weights = weights;
  v.instance = sp.instance & 0x3fffffffu;
  v.dispersion = static_cast<uint32_t>(dispersion) & 3u;
  v.primitive = sp.primitive;
  v.barycentric = sp.barycentric;
  return v;
}

/// Recomputes the surface point of the vertex at the wavelength and time of its subpath. Reads textures at their finest
/// level.
RELUME_HD inline void restore(const SceneView& scene, const PathVertex& v, float wavelength_nm, float time,
                              SurfacePoint& sp) {
  const Ray arrived{v.position, -v.wo, kInfinity, time};
  make_surface_point(scene, arrived, {v.instance, v.primitive, v.barycentric.x, v.barycentric.y, 0.0f}, 0.0f, sp,
                     wavelength_nm);
}

/// Evaluates the scattering of a stored vertex towards `w`.
RELUME_HD inline AdjointEval eval_vertex(const SceneView& scene, const PathVertex& v, const Vec3& w,
                                         float wavelength_nm, float time) {
  if (v.albedo.r >= 0.0f) {
    const float cos_s = glm::dot(v.ns, w);
    const float cos_g = glm::dot(v.ng, w);
    if (cos_g <= 0.0f) return {};
    if (cos_s >= kMinShadingCosine) {
      const float cos_light = glm::dot(v.ns, v.wo);
      const Rgb f = v.albedo * (kInvPi * cos_light / glm::dot(v.ng, v.wo));
      return {f, cosine_hemisphere_pdf(cos_s), cosine_hemisphere_pdf(cos_light)};
    }
  }
  SurfacePoint sp;
  restore(scene, v, wavelength_nm, time, sp);
  return eval_last_adjoint(sp, w);
}

}  // namespace relume
