// Data of a surface point for estimators, caches and filters.
#pragma once

#include "core/region.h"
#include "materials/make_layered_bsdf.h"
#include "scene/scene_view.h"

namespace relume {

/// Minimum cosine of the viewer to the interpolated and mapped normal. Below, the shading frame is bent to the viewer.
inline constexpr float kMinShadingCosine = 1e-3f;

/// Filled by make_surface_point() from a SceneView. Its BSDF points into that view, and must not outlive it. Members
/// have no defaults, for the same reason as in Lobe.
struct SurfacePoint {
  Vec3 position;           ///< metres, world space
  float position_error;    ///< bound on the rounding error per component, metres
  Vec3 previous_position;  ///< position of the same material point in the previous frame, at the same time within the
                           ///< shutter if the displacement is the same for all of these times
  Vec3 ng;                 ///< geometric normal, unit, on the side of wo
  Vec3 ns;                 ///< interpolated and mapped normal, unit, on the side of ng; independent of wo
  Frame frame;             ///< frame.n is the shading normal, on the side of wo: ns, bent where wo is below its horizon
  Vec3 wo;                 ///< unit, towards the viewer
  Vec3 wo_local;           ///< wo in the frame
  Bsdf bsdf;
  Rgb emission;   ///< radiance emitted towards wo
  LightId light;  ///< kNoLight: not an emitter of light selection
  Vec2 barycentric;
  float footprint;  ///< width of the ray cone, metres
  float time;       ///< of the path, within the shutter
  uint32_t instance;
  uint32_t primitive;
  uint32_t material;
  bool front_face;
  uint32_t region = kNoRegion;  ///< region of space for light selection and guiding; set by its users

  RELUME_HD EmitterPoint emitter_point() const { return {position, barycentric, time}; }

  /// Ray towards `w` that avoids hitting its own surface.
  RELUME_HD Ray spawn_ray(const Vec3& w) const {
    return {offset_origin(position, position_error, ng, w), w, kInfinity, time};
  }
};

/// BSDF value and density for world directions. Zero if shading and geometric normal disagree about the side.
template <bool kReverse = false>
RELUME_HD inline BsdfEval eval_pdf(const SurfacePoint& sp, const Vec3& wi,
                                   TransportMode mode = TransportMode::radiance) {
  const Vec3 wi_local = sp.frame.to_local(wi);
  if (glm::dot(wi, sp.ng) * wi_local.z <= 0.0f) return {};
  return eval_pdf<kReverse>(sp.bsdf, sp.wo_local, wi_local, mode);
}

/// Samples a world direction from the BSDF.
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

/// Computes the point where `ray` meets the surface at `hit` of `instance`, that of the hit or one with another
/// placement; without the motion of an open shutter. `cone_width`: width of the ray cone there, metres; it selects
/// texture levels ([Akenine21]). `wavelength_nm`: of the path; it selects the index of refraction.
RELUME_HD void make_surface_point(const SceneView& scene, const Instance& instance, const Ray& ray, const Hit& hit,
                                  float cone_width, SurfacePoint& sp, float wavelength_nm);
/// The same at the time of the ray, if something moves while the shutter is open.
RELUME_HD void make_moved_surface_point(const SceneView& scene, const Ray& ray, const Hit& hit, float cone_width,
                                        SurfacePoint& sp, float wavelength_nm);
/// Computes the point where `ray` meets the surface at `hit`, at the time of the ray.
RELUME_HD inline void make_surface_point(const SceneView& scene, const Ray& ray, const Hit& hit, float cone_width,
                                         SurfacePoint& sp, float wavelength_nm = kNoWavelength) {
  if (!scene.motion.empty()) return make_moved_surface_point(scene, ray, hit, cone_width, sp, wavelength_nm);
  make_surface_point(scene, scene.instances[hit.instance], ray, hit, cone_width, sp, wavelength_nm);
}

/// Current and previous position of a hit's surface point, metres, both at the middle of the shutter.
struct SurfacePosition {
  Vec3 now;
  Vec3 before;
};
RELUME_HD SurfacePosition surface_position(const SceneView& scene, const Hit& hit);

/// Maps vectors at the surface of a hit from the previous frame to the current one. It rotates, stretches and shears
/// with the triangle, and keeps the length of the normal.
RELUME_HD Mat3 previous_to_current(const SceneView& scene, const Hit& hit);

/// Opacity of a triangle at barycentrics (u, v): alpha of the base colour under the alpha mode, 0 or 1 for masks.
RELUME_HD float opacity(const SceneView& scene, uint32_t instance, uint32_t primitive, float u, float v);

}  // namespace relume

#include "scene/surface_point_impl.h"
