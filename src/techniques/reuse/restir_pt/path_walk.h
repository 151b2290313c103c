// Steps along a path from a primary hit that candidates and shifts share: equal random numbers at equal surfaces give
// equal paths. The throughput has no factor of Russian roulette, and none of the wavelength.
#pragma once

#include "techniques/reuse/restir_pt/connect_rule.h"
#include "techniques/reuse/restir_pt/stored_path.h"

namespace relume {

struct PathWalk {
  SurfacePoint sp;        ///< current vertex
  PathState path;         ///< `indirect`: whether a vertex scattered by a lobe with a density
  SegmentEnd from;        ///< previous vertex
  float distance = 0;     ///< from the previous vertex, metres
  float cosine = 0;       ///< |cos| between the last segment and the geometric normal
  float footprint = 0;    ///< primary_footprint()
  bool has_cone = false;  ///< whether a ray cone selects the levels of textures at the next vertices

  /// Width of the ray cone, metres, at `at` metres from the previous vertex.
  RELUME_HD float cone_at(float at) const { return path.cone_width + path.cone_spread * at; }
  /// Solid angle at the previous vertex per area at the current one, 1/m².
  RELUME_HD float geometry() const { return cosine / sqr(distance); }
  /// Weight of the path's wavelength, if a vertex scattered by it.
  RELUME_HD Rgb dispersion() const { return path.dispersed ? wavelength_weight(path.wavelength_nm) : Rgb(1); }
};

/// Starts at the primary hit of a record. `camera`: that of its frame. `instance`: of the hit, as placed in that frame.
/// The caller sets `w.has_cone`. Returns false if nothing scatters there.
RELUME_HD inline bool start_walk(const SceneView& scene, const CameraView& camera, const Instance& instance,
                                 const ReceiverRecord& record, float wavelength_nm, PathWalk& w) {
  w.path = {};
  w.path.ray = {record.origin, record.direction, kInfinity};
  w.path.medium = scene.camera_medium;
  w.path.wavelength_nm = wavelength_nm;
  if (w.has_cone) w.path.cone_spread = camera.cone_spread();
  const float cone = camera.cone_width() + camera.cone_spread() * record.hit.t;
  make_surface_point(scene, instance, w.path.ray, record.hit, cone, w.sp, wavelength_nm);
  absorb(scene, w.sp, record.hit.t, w.path);
  if (scene.disperses) disperse(scene, w.sp, w.sp.ng, TransportMode::importance, w.path);
  w.footprint = primary_footprint(record.hit.t, std::fabs(glm::dot(w.sp.ng, record.direction)));
  return !w.sp.bsdf.empty();
}

/// Moves the sampler to the numbers of the direction that leaves the current vertex, without those of its light.
RELUME_HD inline void skip_light(const PathWalk& w, Sampler& sampler) {
  sampler.start_dimension(kCameraDimensions + w.path.bounce * kDimensionsPerBounce);
  if (has_non_delta(w.sp.bsdf)) sampler.next_2d();
}

/// Begins the ray cone of the segment that leaves the current vertex. Path tracing widens cones by the roughness of the
/// sampled lobe; here it is that of the narrowest one, because shifts choose no lobe where they connect.
RELUME_HD inline void widen_cone(const SegmentEnd& from, PathWalk& w) {
  if (!w.has_cone) return;
  w.path.cone_width = w.sp.footprint;
  w.path.cone_spread = relume::max(w.path.cone_spread, from.delta ? 0.0f : 0.25f * from.alpha);
}

/// Reads textures at full resolution from here on. The light behind joints must not depend on the path before them.
RELUME_HD inline void end_cone(PathWalk& w) {
  w.has_cone = false;
  w.path.cone_width = 0;
  w.path.cone_spread = 0;
}

/// Leaves the current vertex along a sampled direction.
RELUME_HD inline void leave(const SceneView& scene, const BsdfSample& s, PathWalk& w) {
  w.from = segment_end(w.sp, s.wi, s.pdf_w, s.delta, w.path.bounce);
  widen_cone(w.from, w);
  PathState& path = w.path;
  path.throughput *= s.weight;
  path.eta_scale *= s.eta_scale;
  if (scene.disperses) disperse(scene, w.sp, s.wi, TransportMode::importance, path);
  path.ray = w.sp.spawn_ray(s.wi);
  path.medium = medium_along(scene, w.sp, s.wi, path.medium);
  path.pdf_w = s.pdf_w;
  path.delta = s.delta;
  path.indirect = path.indirect || !s.delta;
  ++path.bounce;
}

/// Arrives at the surface that the path's ray hits. Returns the transmittance along the segment, which is part of the
/// throughput. dispersion() is then that of light from the surface.
RELUME_HD inline Rgb arrive(const SceneView& scene, const Hit& hit, PathWalk& w) {
  make_surface_point(scene, w.path.ray, hit, w.cone_at(hit.t), w.sp, w.path.wavelength_nm);
  w.distance = hit.t;
  w.cosine = std::fabs(glm::dot(w.sp.ng, w.path.ray.direction));
  const Rgb transmittance = transmittance_to(scene, w.sp, hit.t, w.path.medium);
  w.path.throughput *= transmittance;
  return transmittance;
}

/// Prepares scattering at the surface where the path has arrived.
RELUME_HD inline void enter(const SceneView& scene, PathWalk& w) {
  if (scene.disperses) disperse(scene, w.sp, w.sp.ng, TransportMode::importance, w.path);
}

/// Light that a surface reflects from a light sample, without occlusion: the integrand over the density of the sample.
/// `medium`: absorption on the viewer's side.
RELUME_HD inline Rgb reflected_light(const SceneView& scene, const SurfacePoint& sp, const Rgb& medium,
                                     const LightSample& light, const BsdfEval& bsdf) {
  Rgb value = bsdf.f * light.radiance * (shading_cosine(sp, light.wi) / light.pdf_w);
  if (scene.absorbs) value *= transmittance(medium_along(scene, sp, light.wi, medium), light.distance);
  return value;
}

/// MIS weight of a sampled direction, against selecting a light with probability `pmf` and the direction with `pdf_li`.
RELUME_HD inline float scatter_weight(float pdf_w, float pmf, float pdf_li) {
  return pmf > 0.0f ? power_heuristic(pdf_w, pmf * pdf_li) : 1.0f;
}

/// MIS weight of a selected light.
RELUME_HD inline float connection_weight(const LightSample& light, float pdf_light, float pdf_scatter) {
  return light.delta ? 1.0f : power_heuristic(pdf_light, pdf_scatter);
}

/// Light from infinity along a direction that the surface at `position` sampled with `pdf_w`, with MIS weights.
/// `delta`: by a delta lobe. `light_pmf(id)`: probability of selecting a light there; not called for dark lights, and
/// not for delta lobes.
template <typename LightPmf>
RELUME_HD inline Rgb light_from_infinity(const LightsView& lights, const Vec3& position, const Vec3& wi, float pdf_w,
                                         bool delta, const LightPmf& light_pmf) {
  Rgb sum(0);
  for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
    const Rgb radiance = radiance_from_infinity(lights, id, wi);
    if (is_black(radiance)) continue;
    const float pmf = delta ? 0.0f : light_pmf(id);
    sum += radiance * scatter_weight(pdf_w, pmf, pmf > 0.0f ? pdf_li(lights, id, position, wi, {}) : 0.0f);
  }
  return sum;
}

/// The same with the selection of the context.
RELUME_HD inline Rgb light_from_infinity(const PathContext& c, const SurfacePoint& sp, const Vec3& wi, float pdf_w,
                                         bool delta) {
  const auto light_pmf = [&](LightId id) { return c.selector.pmf(sp, id); };
  return light_from_infinity(c.scene.lights, sp.position, wi, pdf_w, delta, light_pmf);
}

/// Probability of selecting the light of a hit surface at `sp`; 0 without any.
RELUME_HD inline float pmf_of_hit(const PathContext& c, const SurfacePoint& sp, const Hit& hit) {
  const Instance& instance = c.scene.instances[hit.instance];
  return instance.first_light != kNoLight ? c.selector.pmf(sp, light_of(instance, hit.primitive)) : 0.0f;
}

}  // namespace relume
