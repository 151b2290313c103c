// Everything that estimators, caches and filters need to know of a point on a surface.
#pragma once

#include "core/region.h"
#include "materials/make_layered_bsdf.h"
#include "scene/scene_view.h"

namespace relume {

/// Where the viewer is below this cosine to the interpolated and mapped normal, the shading frame is bent towards it.
inline constexpr float kMinShadingCosine = 1e-3f;

/// Filled by make_surface_point; has no defaults for the reason that Lobe has none.
struct SurfacePoint {
  Vec3 position;           ///< metres, world space
  float position_error;    ///< bound on the rounding error of each component, metres
  Vec3 previous_position;  ///< of the same material point one frame ago
  Vec3 ng;                 ///< geometric normal, unit, on the side of wo
  Vec3 ns;                 ///< interpolated and mapped normal, unit, on the side of ng; depends on no direction
  Frame frame;             ///< frame.n is the shading normal, on the side of wo: ns, bent where wo is below it
  Vec3 wo;                 ///< unit, towards the viewer
  Vec3 wo_local;           ///< the same in the frame
  Bsdf bsdf;
  Rgb emission;   ///< radiance emitted towards wo
  LightId light;  ///< kNoLight: not an emitter that light selection knows
  Vec2 barycentric;
  float footprint;  ///< width of the ray cone, metres
  uint32_t instance;
  uint32_t primitive;
  uint32_t material;
  bool front_face;
  uint32_t region = kNoRegion;  ///< of space, in which light selection and guiding have learnt; set by who uses them

  RELUME_HD EmitterPoint emitter_point() const { return {position, barycentric}; }

  /// Ray from here towards `w` that cannot meet its own surface.
  RELUME_HD Ray spawn_ray(const Vec3& w) const {
    return {offset_origin(position, position_error, ng, w), w, kInfinity};
  }
};

/// BSDF value and density for world directions, zero where shading and geometric normal disagree about the side.
template <bool kReverse = false>
RELUME_HD inline BsdfEval eval_pdf(const SurfacePoint& sp, const Vec3& wi,
                                   TransportMode mode = TransportMode::radiance) {
  const Vec3 wi_local = sp.frame.to_local(wi);
  if (glm::dot(wi, sp.ng) * wi_local.z <= 0.0f) return {};
  return eval_pdf<kReverse>(sp.bsdf, sp.wo_local, wi_local, mode);
}

/// A world direction from the BSDF.
RELUME_HD inline BsdfSample sample(const SurfacePoint& sp, float u_lobe, const Vec2& u,
                                   TransportMode mode = TransportMode::radiance) {
  BsdfSample s = sample(sp.bsdf, sp.wo_local, u_lobe, u, mode);
  const float local_z = s.wi.z;
  s.wi = sp.frame.to_world(s.wi);
  if (glm::dot(s.wi, sp.ng) * local_z <= 0.0f) s.valid = false;
  return s;
}

/// |cos| between the shading normal and `w`.
RELUME_HD inline float shading_cosine(const SurfacePoint& sp, const Vec3& w) {
  return std::fabs(glm::dot(sp.frame.n, w));
}

/// The point that `ray` meets at `hit`. `cone_width` is the width of the ray cone there, metres; it selects texture
/// levels ([Akenine21]). `wavelength_nm` of the path selects the index of refraction.
RELUME_HD void make_surface_point(const SceneView& scene, const Ray& ray, const Hit& hit, float cone_width,
                                  SurfacePoint& sp, float wavelength_nm = kNoWavelength);

/// Where a hit's point of the surface is now, and where it was one frame ago, metres.
struct SurfacePosition {
  Vec3 now;
  Vec3 before;
};
RELUME_HD SurfacePosition surface_position(const SceneView& scene, const Hit& hit);

/// Maps vectors at the surface of a hit from one frame ago to now. It rotates, stretches and shears with the triangle,
/// whose normal keeps its length.
RELUME_HD Mat3 previous_to_current(const SceneView& scene, const Hit& hit);

/// Opacity of a triangle at barycentrics (u, v): base colour alpha as alpha mode asks, 0 or 1 for masks.
RELUME_HD float opacity(const SceneView& scene, uint32_t instance, uint32_t primitive, float u, float v);

}  // namespace relume

#include "scene/surface_point_impl.h"
