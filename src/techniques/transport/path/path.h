// Unidirectional path tracing with next event estimation and multiple importance sampling at every vertex ([Veach97],
// ch. 9 and 10). The steps are functions of their own, which trace_path() strings together.
#pragma once

#include "sampling/mis.h"
#include "scene/dispersion.h"
#include "scene/medium.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/transport/path/path_policy.h"

namespace relume {

/// What a path carries from vertex to vertex.
struct PathState {
  Ray ray;
  Rgb throughput{1};
  Rgb radiance{0};
  float eta_scale = 1;  ///< product of the factors in the throughput that roulette must ignore: 1/η² and the largest
                        ///< component of the wavelength's weight
  float rr_reference = 1;  ///< its largest component after the first bounce: the scale of what the pixel shows
  float pdf_w = 0;         ///< with which the ray's direction was sampled
  float wavelength_nm = kNoWavelength;  ///< of the whole path; none in scenes without dispersion
  bool dispersed = false;  ///< some vertex scattered by wavelength; throughput has its weight, except of light subpaths
  bool delta = true;       ///< the ray leaves the camera or a delta lobe: only this strategy finds emitters along it
  Rgb medium{0};           ///< absorption along the ray, per metre: that of all bodies it is in
  float cone_width = 0;    ///< metres, at the ray's origin
  float cone_spread = 0;   ///< growth a metre
  uint32_t bounce = 0;     ///< scattering events so far
  uint32_t rays = 0;
};

/// A sampled connection to a light, to be added if nothing is in between.
struct Connection {
  Ray ray;
  Rgb contribution{0};
  uint32_t ray_id = 0;
  LightId light = kNoLight;
  Vec2 u{0};          ///< with which the point on the light was chosen
  Rgb irradiance{0};  ///< radiance · cos / pdf_w of that point
  float scale = 0;  ///< MIS weight / pmf: the contribution is throughput · f · irradiance · scale · dispersion_weight()

  RELUME_HD bool valid() const { return !is_black(contribution); }
};

struct PathContext {
  SceneView scene;
  LightSelector selector;
  DirectionSampler directions;
  uint32_t max_bounces = 8;
  bool russian_roulette = true;
};

/// The end of a shadow ray stays clear of what is there by this share of the distance.
inline constexpr float kShadowMargin = 1e-4f;

/// From a surface to what is `distance` metres away in direction `w`: meets neither of the two, only what is between.
RELUME_HD inline Ray shadow_ray(const SurfacePoint& sp, const Vec3& w, float distance) {
  Ray ray = sp.spawn_ray(w);
  ray.t_max = distance * (1.0f - kShadowMargin);
  return ray;
}

/// The same to a light.
RELUME_HD inline Ray shadow_ray(const SurfacePoint& sp, const LightSample& light) {
  Ray ray = shadow_ray(sp, light.wi, light.distance);
  ray.t_max = relume::min(ray.t_max, relume::max(light.distance - light.clearance, 0.0f));
  return ray;
}

/// The sampler's dimension of the wavelength, beyond those of the longest paths from camera and light.
inline constexpr uint32_t kWavelengthDimension = 8192;

/// The wavelength of a pixel's sample, nanometres; of its path and, in bidirectional tracing, of both subpaths.
RELUME_HD inline float path_wavelength(const SceneView& scene, const Sampler& sampler) {
  return scene.disperses ? sample_wavelength(sampler.number_of(kWavelengthDimension)) : kNoWavelength;
}

/// Factor of a connection from `sp` towards `w`: the weight of the path's wavelength if scattering there depends on it
/// and the throughput does not have it yet, else 1.
RELUME_HD inline Rgb dispersion_weight(const SceneView& scene, const SurfacePoint& sp, const Vec3& w,
                                       const PathState& path) {
  return !path.dispersed && disperses(scene, sp, w) ? wavelength_weight(path.wavelength_nm) : Rgb(1);
}

/// Emission at the hit surface, weighted against next event estimation from the previous vertex. Returns whether that
/// could have found it.
RELUME_HD inline bool add_surface_emission(const PathContext& c, const SurfacePoint& previous, const SurfacePoint& sp,
                                           PathState& path) {
  if (is_black(sp.emission)) return false;
  const bool lights_know = !path.delta && sp.light != kNoLight;
  float weight = 1.0f;
  if (lights_know) {
    const float pdf_light = c.selector.pmf(previous, sp.light) *
                            pdf_li(c.scene.lights, sp.light, previous.position, path.ray.direction, sp.emitter_point());
    weight = power_heuristic(path.pdf_w, pdf_light);
  }
  path.radiance += path.throughput * sp.emission * weight;
  return lights_know;
}

/// Light from infinity along a ray that left the scene. Returns whether next event estimation could have found it.
RELUME_HD inline bool add_infinite_lights(const PathContext& c, const SurfacePoint& previous, PathState& path) {
  const LightsView& lights = c.scene.lights;
  const Vec3& wi = path.ray.direction;
  bool lights_know = false;
  for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
    const Rgb radiance = radiance_from_infinity(lights, id, wi);
    if (is_black(radiance)) continue;
    float weight = 1.0f;
    if (!path.delta) {
      const float pmf = c.selector.pmf(previous, id);
      if (pmf > 0.0f) weight = power_heuristic(path.pdf_w, pmf * pdf_li(lights, id, previous.position, wi, {}));
      lights_know = lights_know || pmf > 0.0f;
    }
    path.radiance += path.throughput * radiance * weight;
  }
  return lights_know;
}

/// A light and a point on it, as seen from a surface.
struct LightPick {
  LightId id = kNoLight;
  float pmf = 0;  ///< of the selector
  LightSample light;
  Vec2 u{0};  ///< what placed the sample on the light
};

RELUME_HD inline LightPick pick_light(const PathContext& c, const SurfacePoint& sp, Sampler& sampler) {
  Vec2 u = sampler.next_2d();
  const LightSelection selection = c.selector.sample(sp, sampler.reusable(u.x));
  if (!(selection.pmf > 0.0f)) return {};
  u.x = selection.u;
  return {selection.light, selection.pmf, sample_li(c.scene.lights, selection.light, sp.position, u), u};
}

/// Chooses a light and a point on it; its contribution carries throughput, BSDF and MIS weight. Filled in place, for
/// hosts keep many. False, and `connection` undefined, if nothing arrives.
RELUME_HD inline bool sample_connection(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                        Sampler& sampler, Connection& connection) {
  const LightPick pick = pick_light(c, sp, sampler);
  const LightSample& light = pick.light;
  if (!light.valid()) return false;
  const BsdfEval bsdf = eval_pdf(sp, light.wi);
  if (is_black(bsdf.f)) return false;
  const float pdf_light = pick.pmf * light.pdf_w;
  const float weight = light.delta ? 1.0f : power_heuristic(pdf_light, c.directions.pdf(sp, light.wi, bsdf));
  connection.ray = shadow_ray(sp, light);
  connection.ray_id = sampler.ray_id();
  connection.light = pick.id;
  connection.u = pick.u;
  connection.irradiance = light.radiance * (shading_cosine(sp, light.wi) / light.pdf_w);
  if (c.scene.absorbs) {
    connection.irradiance *= transmittance(medium_along(c.scene, sp, light.wi, path.medium), light.distance);
  }
  connection.scale = weight / pick.pmf;
  connection.contribution = path.throughput * bsdf.f * connection.irradiance * connection.scale;
  if (c.scene.disperses) connection.contribution *= dispersion_weight(c.scene, sp, light.wi, path);
  return connection.valid();
}

/// Absorption along the segment that ends at a surface.
RELUME_HD inline void absorb(const SceneView& scene, const SurfacePoint& sp, float distance, PathState& path) {
  path.throughput *= transmittance_to(scene, sp, distance, path.medium);
}

/// Roulette begins where throughput, relative to that of the first bounce, falls below the inverse of this, and keeps
/// it there. Relative, because a pixel's noise is seen against the albedo of what it shows. Larger: less noise, more
/// rays.
inline constexpr float kRouletteThreshold = 1.1f;

/// Applies the weight of the wavelength at the first vertex that scatters by it, where the path continues towards `w`.
/// Light subpaths (importance) leave the weight to their connections.
RELUME_HD inline void disperse(const SceneView& scene, const SurfacePoint& sp, const Vec3& w, TransportMode mode,
                               PathState& path) {
  if (path.dispersed || !disperses(scene, sp, w)) return;
  path.dispersed = true;
  if (mode == TransportMode::importance) return;
  const Rgb weight = wavelength_weight(path.wavelength_nm);
  path.throughput *= weight;
  path.eta_scale *= max_component(weight);
}

/// Takes the path on along a sampled direction; false if it ends here.
RELUME_HD inline bool follow(const PathContext& c, const SurfacePoint& sp, const BsdfSample& s, PathState& path,
                             Sampler& sampler, TransportMode mode = TransportMode::radiance) {
  if (!s.valid) return false;
  path.throughput *= s.weight;
  path.eta_scale *= s.eta_scale;
  if (c.scene.disperses) disperse(c.scene, sp, s.wi, mode, path);
  // Black ends the path. So does what is not a number, but that the pixel must report.
  if (!(path.throughput.r + path.throughput.g + path.throughput.b > 0.0f)) {
    path.radiance += path.throughput;
    return false;
  }
  if (path.bounce == 0) {
    path.rr_reference = max_component(path.throughput) / path.eta_scale;
  } else if (c.russian_roulette) {
    const float survival = kRouletteThreshold * max_component(path.throughput) / (path.eta_scale * path.rr_reference);
    if (survival < 1.0f) {
      if (sampler.next_1d() >= survival) return false;
      path.throughput /= survival;
    }
  }
  path.ray = sp.spawn_ray(s.wi);
  path.medium = medium_along(c.scene, sp, s.wi, path.medium);
  path.pdf_w = s.pdf_w;
  path.delta = s.delta;
  path.cone_width = sp.footprint;
  // A rough lobe fans the cone out; half of α is about the lobe's angular width ([Akenine21], §4).
  path.cone_spread = relume::max(path.cone_spread, 0.25f * s.alpha);
  ++path.bounce;
  return true;
}

/// Next direction; false if the path ends here.
RELUME_HD inline bool continue_path(const PathContext& c, const SurfacePoint& sp, PathState& path, Sampler& sampler) {
  return follow(c, sp, c.directions.sample(sp, sampler), path, sampler);
}

/// Pairs of random numbers of each bounce, after the camera's: one for the light and one for the direction.
inline constexpr uint32_t kDimensionsPerBounce = 2;

/// A path before its first hit.
RELUME_HD inline PathState start_path(const PathContext& c, uint32_t x, uint32_t y, Sampler& sampler) {
  PathState path;
  path.ray = camera_ray(c.scene.camera, x, y, sampler);
  path.cone_width = c.scene.camera.cone_width();
  path.cone_spread = c.scene.camera.cone_spread();
  path.medium = c.scene.camera_medium;
  path.wavelength_nm = path_wavelength(c.scene, sampler);
  path.rays = 1;
  return path;
}

/// The vertex at the end of the path's ray: fills `sp` and adds what it emits. False if the path ends here.
template <typename Policy>
RELUME_HD inline bool arrive(const PathContext& c, const Hit& hit, const SurfacePoint& previous, SurfacePoint& sp,
                             PathState& path, Policy& policy) {
  if (!hit.valid()) {
    policy.emitted(path, add_infinite_lights(c, previous, path));
    return false;
  }
  make_surface_point(c.scene, path.ray, hit, path.cone_width + path.cone_spread * hit.t, sp, path.wavelength_nm);
  absorb(c.scene, sp, hit.t, path);
  policy.emitted(path, add_surface_emission(c, previous, sp, path));
  return path.bounce < c.max_bounces && !sp.bsdf.empty() && policy.arrived(sp, path);
}

/// Next event estimation at a vertex: whether there is a connection to be tested; none where only delta lobes scatter.
RELUME_HD inline bool connect(const PathContext& c, const SurfacePoint& sp, const PathState& path, Sampler& sampler,
                              Connection& connection) {
  sampler.start_dimension(kCameraDimensions + path.bounce * kDimensionsPerBounce);
  return has_non_delta(sp.bsdf) && sample_connection(c, sp, path, sampler, connection);
}

/// Takes a path on from what its ray has hit until it ends. The vertex there goes into points[bounce & 1]; the other
/// one is the vertex before.
template <typename Policy>
RELUME_HD inline void walk(const PathContext& c, Hit hit, SurfacePoint (&points)[2], PathState& path, Sampler& sampler,
                           Policy& policy) {
  for (;;) {
    SurfacePoint& sp = points[path.bounce & 1u];
    const SurfacePoint& previous = points[(path.bounce & 1u) ^ 1u];
    if (!arrive(c, hit, previous, sp, path, policy)) break;
    if constexpr (DecidesLater<Policy>) {
      if (!policy.goes_on(path)) break;
    }
    if (Connection connection; connect(c, sp, path, sampler, connection)) {
      ++path.rays;
      const bool visible = !occluded(c.scene.accel, connection.ray, connection.ray_id);
      if (visible) path.radiance += connection.contribution;
      policy.connected(sp, path, connection, visible);
    }
    const BsdfSample s = c.directions.sample(sp, sampler);
    if (!follow(c, sp, s, path, sampler)) break;
    policy.scattered(sp, s, path);
    hit = intersect(c.scene.accel, path.ray, sampler.ray_id());
    ++path.rays;
  }
  policy.finished(path);
}

/// Radiance of one sample of pixel (x, y) from its primary hit on.
template <typename Policy = NoPolicy>
RELUME_HD inline PathState trace_path(const PathContext& c, uint32_t x, uint32_t y, Sampler& sampler, const Hit& hit,
                                      Policy&& policy = Policy{}) {
  PathState path = start_path(c, x, y, sampler);
  SurfacePoint points[2];
  points[1].position = path.ray.origin;
  walk(c, hit, points, path, sampler, policy);
  return path;
}

}  // namespace relume
