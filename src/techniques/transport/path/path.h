// Unidirectional path tracing with next event estimation and multiple importance sampling at every vertex ([Veach97],
// ch. 9 and 10). Each step is a separate function. walk() runs them in order for one path (walk.h), trace() for the
// paths of a batch (path_batch.h).
#pragma once

#include "core/hash.h"
#include "sampling/mis.h"
#include "scene/dispersion.h"
#include "scene/medium.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/transport/path/indirect_rate.h"
#include "techniques/transport/path/path_policy.h"

namespace relume {

/// State of a path between vertices.
struct PathState {
  Ray ray;
  Rgb throughput{1};
  Rgb radiance{0};
  float eta_scale = 1;  ///< product of the throughput factors ignored by roulette: 1/η² and the largest component of
                        ///< the wavelength weight
  float rr_reference = 1;  ///< largest component of the throughput after the first bounce: reference of roulette
  float pdf_w = 0;         ///< density of the ray's direction, per steradian
  float wavelength_nm = kNoWavelength;  ///< of the whole path; kNoWavelength in scenes without dispersion
  bool dispersed = false;  ///< whether a vertex scattered by wavelength; throughput then includes the weight, except on
                           ///< light subpaths
  bool delta = true;  ///< whether the ray leaves the camera or a delta lobe, where next event estimation has no density
  Rgb medium{0};      ///< absorption along the ray, per metre: the sum over all media around it
  float cone_width = 0;       ///< footprint at the ray's origin, metres
  float cone_spread = 0;      ///< growth per metre
  float indirect_weight = 1;  ///< IndirectRate::weight() of the pixel
  bool indirect = false;      ///< past the first non-specular vertex; the throughput then includes that weight
  uint32_t bounce = 0;        ///< scattering events so far
  uint32_t rays = 0;
};

/// A sampled connection to a light, added if it is not blocked.
struct Connection {
  Ray ray;
  Rgb contribution{0};
  uint32_t ray_id = 0;  ///< seed of stochastic alpha along the ray
  LightId light = kNoLight;
  Vec2 u{0};          ///< random numbers of the point on the light
  Rgb irradiance{0};  ///< radiance that arrives at the surface · cosine there / pdf_w
  float scale = 0;  ///< LightPick::factor · MIS weight / pmf. The contribution is throughput · f · irradiance · scale
                    ///< · dispersion_weight()
  bool dispersed = false;  ///< the contribution includes the weight of the path's wavelength

  RELUME_HD bool valid() const { return !is_black(contribution); }
};

/// Whether reservoirs can take over the light of a source. A constant environment is left to paths: no selection
/// samples it.
RELUME_HD inline bool reservoirs_take(const LightsView& lights, LightId light) {
  return lights.lights[light].kind != LightKind::environment || lights.environment.worth_sampling();
}

struct PathContext {
  SceneView scene;
  LightSelector selector;
  DirectionSampler directions;
  uint32_t max_bounces = 8;
  bool russian_roulette = true;
  IndirectRate indirect;
  uint32_t first_nee_bounce = 0;  ///< vertices of earlier bounces leave light sources to reservoirs (techniques/reuse)
  uint32_t light_candidates = 1;  ///< lights sampled at a primary hit, of which next event estimation takes one; above
                                  ///< 1 only with policies that resample lights (path_policy.h)
  bool indirect_to_reservoirs = false;  ///< whether reservoirs resample the light beyond the second vertex
  bool only_specular = false;           ///< whether paths end at lobes with a density, whose light reservoirs add
  bool next_event = true;               ///< whether vertices connect to lights that directions can find, too

  /// Number of lights sampled at a vertex of this bounce, a factor of their density in MIS weights.
  RELUME_HD float light_samples(uint32_t bounce) const {
    return bounce == 0 ? static_cast<float>(static_cast<int>(light_candidates)) : 1.0f;
  }
  /// Whether reservoirs add the light that reaches a vertex from `light`, found by the path's current ray.
  RELUME_HD bool left_to_reservoirs(const PathState& path, LightId light) const {
    return path.bounce <= first_nee_bounce && !path.delta && reservoirs_take(scene.lights, light);
  }
};

/// Shadow rays are shortened by this fraction of the distance, to avoid hitting the light.
inline constexpr float kShadowMargin = 1e-4f;

/// Ray from a surface towards a point `distance` metres away along `w`. It avoids hits at both ends.
RELUME_HD inline Ray shadow_ray(const SurfacePoint& sp, const Vec3& w, float distance) {
  Ray ray = sp.spawn_ray(w);
  ray.t_max = distance * (1.0f - kShadowMargin);
  return ray;
}

/// Shadow ray towards a light sample.
RELUME_HD inline Ray shadow_ray(const SurfacePoint& sp, const LightSample& light) {
  Ray ray = shadow_ray(sp, light.wi, light.distance);
  ray.t_max = relume::min(ray.t_max, relume::max(light.distance - light.clearance, 0.0f));
  return ray;
}

/// Seed of stochastic alpha along the shadow rays of reservoirs at a primary hit; independent of the camera ray's.
RELUME_HD inline uint32_t reservoir_ray_id(const Sampler& sampler) {
  constexpr uint32_t kSalt = 0x6a09e667u;
  return hash(sampler.camera_ray_id(), kSalt);
}

/// Seed of stochastic alpha along the path's ray. Where that ray finds candidates for reservoirs, it is the seed of
/// their shadow rays: a second draw at the same surface would count its opacity twice.
RELUME_HD inline uint32_t ray_id_of(const PathContext& c, const PathState& path, const Sampler& sampler) {
  const uint32_t last = c.indirect_to_reservoirs ? 1u : c.first_nee_bounce;
  return path.bounce <= last ? reservoir_ray_id(sampler) : sampler.ray_id();
}

/// Sampler dimension of the wavelength, beyond those of the longest camera and light paths.
inline constexpr uint32_t kWavelengthDimension = 8192;
/// First sampler dimension of the candidate lights at a primary hit, beyond that of the wavelength.
inline constexpr uint32_t kCandidateDimension = kWavelengthDimension + 64;

/// Wavelength of a pixel's sample, nanometres. In bidirectional tracing both subpaths share it.
RELUME_HD inline float path_wavelength(const SceneView& scene, const Sampler& sampler) {
  return scene.disperses ? sample_wavelength(sampler.number_of(kWavelengthDimension)) : kNoWavelength;
}

/// Wavelength factor of a connection from `sp` towards `w`. It is the weight of the path's wavelength if scattering
/// there depends on it and the throughput excludes it, else 1.
RELUME_HD inline Rgb dispersion_weight(const SceneView& scene, const SurfacePoint& sp, const Vec3& w,
                                       const PathState& path) {
  return !path.dispersed && disperses(scene, sp, w) ? wavelength_weight(path.wavelength_nm) : Rgb(1);
}

/// Adds the emission of the hit surface, weighted against next event estimation from the previous vertex, at
/// `previous`. `light_pmf(id)`: probability with which the selector chooses a light there. Returns whether next event
/// estimation could have sampled it.
template <typename LightPmf>
RELUME_HD inline bool add_surface_emission(const PathContext& c, const Vec3& previous, const LightPmf& light_pmf,
                                           const SurfacePoint& sp, PathState& path) {
  if (is_black(sp.emission)) return false;
  const bool covered_by_nee = c.next_event && !path.delta && sp.light != kNoLight;
  if (covered_by_nee && c.left_to_reservoirs(path, sp.light)) return true;
  float weight = 1.0f;
  if (covered_by_nee) {
    const float pdf_light =
        light_pmf(sp.light) * pdf_li(c.scene.lights, sp.light, previous, path.ray.direction, sp.emitter_point());
    weight = power_heuristic(path.pdf_w, c.light_samples(path.bounce - 1) * pdf_light);
  }
  path.radiance += path.throughput * sp.emission * weight;
  return covered_by_nee;
}

/// Adds light from infinity along a ray that left the scene, weighted in the same way. Returns whether next event
/// estimation could have sampled it.
RELUME_HD inline bool add_infinite_lights(const PathContext& c, const SurfacePoint& previous, PathState& path) {
  const LightsView& lights = c.scene.lights;
  const Vec3& wi = path.ray.direction;
  bool covered_by_nee = false;
  for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
    const Rgb radiance = radiance_from_infinity(lights, id, wi);
    if (is_black(radiance)) continue;
    if (c.left_to_reservoirs(path, id)) {
      covered_by_nee = true;
      continue;
    }
    float weight = 1.0f;
    if (c.next_event && !path.delta) {
      const float pmf = c.selector.pmf(previous, id);
      if (pmf > 0.0f) {
        const float pdf_light = pmf * pdf_li(lights, id, previous.position, wi, {});
        weight = power_heuristic(path.pdf_w, c.light_samples(path.bounce - 1) * pdf_light);
      }
      covered_by_nee = covered_by_nee || pmf > 0.0f;
    }
    path.radiance += path.throughput * radiance * weight;
  }
  return covered_by_nee;
}

/// A light selected at a surface.
struct LightPick {
  LightId id = kNoLight;
  float pmf = 0;     ///< probability of the light under the selector; 0: no light
  Vec2 u{0};         ///< random numbers of the point on the light
  float factor = 1;  ///< of the light, where it was chosen among several
};

RELUME_HD inline LightPick pick_light(const PathContext& c, const SurfacePoint& sp, Sampler& sampler) {
  const Vec2 u = sampler.next_2d();
  const LightSelection selection = c.selector.sample(sp, sampler.reusable(u.x));
  return {selection.light, selection.pmf, {selection.u, u.y}};
}

/// The picked light's sample at the surface; invalid if there is no light.
RELUME_HD inline LightSample sample_picked(const PathContext& c, const SurfacePoint& sp, const LightPick& pick) {
  return pick.pmf > 0.0f ? sample_li(c.scene.lights, pick.id, sp.position, pick.u, sp.time) : LightSample{};
}

/// Makes a connection to a sample of a light. Its contribution includes throughput, BSDF and MIS weight. Returns false,
/// with `connection` undefined, if it carries no light. It is filled in place, because host batches store many.
RELUME_HD inline bool make_connection(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                      const LightPick& pick, const LightSample& light, const Sampler& sampler,
                                      Connection& connection) {
  if (!light.valid() || (!c.next_event && !light.delta)) return false;
  const BsdfEval bsdf = eval_pdf(sp, light.wi);
  if (is_black(bsdf.f)) return false;
  const float pdf_light = c.light_samples(path.bounce) * (pick.pmf * light.pdf_w);
  const float weight = light.delta ? 1.0f : power_heuristic(pdf_light, c.directions.pdf(sp, light.wi, bsdf));
  connection.ray = shadow_ray(sp, light);
  connection.ray_id = sampler.ray_id();
  connection.light = pick.id;
  connection.u = pick.u;
  connection.irradiance = light.radiance * (shading_cosine(sp, light.wi) / light.pdf_w);
  if (c.scene.absorbs) {
    connection.irradiance *= transmittance(medium_along(c.scene, sp, light.wi, path.medium), light.distance);
  }
  connection.scale = pick.factor * weight / pick.pmf;
  connection.contribution = path.throughput * bsdf.f * connection.irradiance * connection.scale;
  connection.dispersed = path.dispersed || disperses(c.scene, sp, light.wi);
  if (connection.dispersed) connection.contribution *= dispersion_weight(c.scene, sp, light.wi, path);
  return connection.valid();
}

/// Applies the absorption along the segment that ends at a surface.
RELUME_HD inline void absorb(const SceneView& scene, const SurfacePoint& sp, float distance, PathState& path) {
  path.throughput *= transmittance_to(scene, sp, distance, path.medium);
}

/// Factor of Russian roulette: survival probability over the throughput relative to that after the first bounce (noise
/// is seen against the albedo of the visible surface). Larger values reduce noise and trace more rays.
inline constexpr float kRouletteThreshold = 1.1f;

/// Applies the wavelength weight at the first vertex that scatters by wavelength, where the path continues towards `w`.
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

/// Continues the path along a sampled direction. Returns false if it ends here.
RELUME_HD inline bool follow(const PathContext& c, const SurfacePoint& sp, const BsdfSample& s, PathState& path,
                             Sampler& sampler, TransportMode mode = TransportMode::radiance) {
  if (!s.valid || (c.only_specular && !s.delta)) return false;
  path.throughput *= s.weight;
  path.eta_scale *= s.eta_scale;
  if (!s.delta && !path.indirect) {
    if (path.indirect_weight == 0.0f) return false;
    path.throughput *= path.indirect_weight;
    path.indirect = true;
  }
  if (c.scene.disperses) disperse(c.scene, sp, s.wi, mode, path);
  // A black throughput ends the path. So does NaN, which is added to the radiance for the pixel to report.
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
  // A rough lobe widens the cone; half of α is about the angular width of the lobe ([Akenine21], §4).
  path.cone_spread = relume::max(path.cone_spread, 0.25f * s.alpha);
  ++path.bounce;
  return true;
}

/// Pairs of random numbers per bounce, after those of the camera: one for the light, one for the direction.
inline constexpr uint32_t kDimensionsPerBounce = 2;

/// State of a path before its first hit.
RELUME_HD inline PathState start_path(const PathContext& c, uint32_t x, uint32_t y, Sampler& sampler) {
  PathState path;
  path.ray = camera_ray(c.scene.camera, x, y, sampler);
  path.cone_width = c.scene.camera.cone_width();
  path.cone_spread = c.scene.camera.cone_spread();
  path.medium = c.scene.camera_medium;
  path.wavelength_nm = path_wavelength(c.scene, sampler);
  path.indirect_weight = c.indirect.weight(x, y);
  path.rays = 1;
  return path;
}

/// Evaluates the vertex on the hit surface: fills `sp` and adds its emission. `previous`, `light_pmf`: as for
/// add_surface_emission(). Returns false if the path ends here.
template <typename LightPmf, typename Policy>
RELUME_HD inline bool arrive_at_surface(const PathContext& c, const Hit& hit, const Vec3& previous,
                                        const LightPmf& light_pmf, SurfacePoint& sp, PathState& path, Policy& policy) {
  make_surface_point(c.scene, path.ray, hit, path.cone_width + path.cone_spread * hit.t, sp, path.wavelength_nm);
  absorb(c.scene, sp, hit.t, path);
  policy.hit_surface(sp, path);
  policy.emitted(path, add_surface_emission(c, previous, light_pmf, sp, path));
  // Inside a dispersive medium even reflection depends on the wavelength: policies see a dispersed path from here on,
  // and caches bypass the vertex.
  if (c.scene.disperses) disperse(c.scene, sp, sp.ng, TransportMode::radiance, path);
  return path.bounce < c.max_bounces && !sp.bsdf.empty() && policy.arrived(sp, path);
}

/// Evaluates the vertex at the end of the ray, which is light from infinity if nothing is hit. Fills `sp`, a point
/// other than `previous`. Returns false if the path ends here.
template <typename Policy>
RELUME_HD inline bool arrive(const PathContext& c, const Hit& hit, const SurfacePoint& previous, SurfacePoint& sp,
                             PathState& path, Policy& policy) {
  if (!hit.valid()) {
    policy.emitted(path, add_infinite_lights(c, previous, path));
    return false;
  }
  const auto light_pmf = [&](LightId light) { return c.selector.pmf(previous, light); };
  return arrive_at_surface(c, hit, previous.position, light_pmf, sp, path, policy);
}

/// Starts the random numbers of a vertex. Returns whether next event estimation samples lights there: not where only
/// delta lobes scatter, or where reservoirs add the light.
RELUME_HD inline bool start_vertex(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                   Sampler& sampler) {
  sampler.start_dimension(kCameraDimensions + path.bounce * kDimensionsPerBounce);
  return !c.only_specular && has_non_delta(sp.bsdf) && path.bounce >= c.first_nee_bounce;
}

/// Starts a vertex, and selects the light of next event estimation there, if any.
RELUME_HD inline LightPick pick_light_at(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                         Sampler& sampler) {
  if (!start_vertex(c, sp, path, sampler)) return {};
  return pick_light(c, sp, sampler);
}

}  // namespace relume
