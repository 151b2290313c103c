// Camera subpaths: they meet lights (s = 0, met_lights.h), and connect to sampled points on lights (s = 1) and to
// vertices of a light subpath (s ≥ 2).
#pragma once

#include <type_traits>

#include "techniques/transport/bdpt/met_lights.h"

namespace relume {

/// Whether a camera subpath has a policy that may change it.
template <typename Policy>
inline constexpr bool kIsPolicy = !std::is_same_v<Policy, NoPolicy>;

/// Whether the policy leaves light beyond second vertices to reservoirs, and then weights it (subpath_samples.h).
template <typename Policy>
inline constexpr bool kSamplesIndirectLight = requires {
  requires Policy::samples_indirect_light;
};

/// Whether the last vertex is a primary hit whose connections to surfaces such a policy leaves out.
template <typename Policy>
RELUME_HD inline bool leaves_out_surfaces(const CameraSubpath& e) {
  return kSamplesIndirectLight<Policy> && e.path.bounce == 0;
}

/// SubpathUnits::unit; without a policy, the code for it compiles away.
template <typename Policy>
RELUME_HD inline Rgb unit_of(const CameraSubpath& e) {
  return kIsPolicy<Policy> ? e.units.unit : Rgb(1);
}

/// Radiance that the subpath has found so far, as it counts in the image.
template <typename Policy>
RELUME_HD inline Rgb found_in_image(const CameraSubpath& e) {
  return kIsPolicy<Policy> ? e.units.before + e.units.unit * e.path.radiance : e.path.radiance;
}

/// Evaluates the BSDF at the last vertex. The reverse density doubles the cost, so it is computed only if strategies
/// that cut before the vertex exist. Both include guiding.
template <typename Context>
RELUME_HD inline BsdfEval eval_camera_vertex(const Context& c, const CameraSubpath& e, const SurfacePoint& sp,
                                             const Vec3& wi) {
  BsdfEval result = eval_pdf(sp, wi);
  if (e.weights.at().b > 0.0f && !is_black(result.f)) result.pdf_reverse = other_sides_pdf(sp, wi);
  if (Context::kLearns && !is_black(result.f)) {
    const GuidedPoint guide = guided_point(c, sp);
    result.pdf_forward = camera_pdf(c, guide, wi, result.pdf_forward);
    result.pdf_reverse = light_pdf(c, guide, sp.wo, result.pdf_reverse);
  }
  return result;
}

/// Weight of a connection to a point on a light (s = 1).
template <typename Recorder = NoRecorder>
RELUME_HD inline float weight_of_light_connection(const BdptContext& c, const SurfacePoint& sp, const CameraSubpath& e,
                                                  const LightPick& pick, const LightSample& light, const BsdfEval& bsdf,
                                                  Recorder&& recorder = Recorder{}) {
  const float pmf = weighting_pmf(c, pick.id);
  if (!(pmf > 0.0f)) return 0.0f;
  const EmissionPdf pdf = pdf_le(c.scene().lights, pick.id, {light.position, light.barycentric, sp.time}, -light.wi);
  const bool infinite = pick.id >= c.scene().lights.first_infinite;
  // Weights assume that connections find points of lights as emission does: by area.
  const float found_by_area =
      infinite ? pdf.pdf_w
               : pdf_w_from_pdf_a(pdf.pdf_a, sqr(light.distance), std::fabs(glm::dot(light.normal, light.wi)));
  const float met = light.delta ? 0.0f : sqr(bsdf.pdf_forward / (pmf * found_by_area));
  if (e.count() + 1 > c.max_bidirectional_vertices()) {
    recorder.weigh({1.0f + met});
    return weight_from(met, 0.0f);
  }
  const float onwards = infinite ? pdf.pdf_a : pdf.pdf_w / sqr(light.distance);
  const float found = c.emission.pmf(pick.id) / pmf * onwards * std::fabs(glm::dot(sp.ng, light.wi));
  recorder.weigh(weight_terms(met, found, bsdf.pdf_reverse, e.weights.merging(), 1.0f));
  return weight_from(met, e.weights.sum(found, bsdf.pdf_reverse));
}

/// s = 1: connects to a point on a light chosen by the selector. Reservoirs add the light of such connections at the
/// primary hit, so there is none.
template <typename Context, typename Recorder>
RELUME_HD inline Connection connect_to_light(const Context& c, const SurfacePoint& sp, const CameraSubpath& e,
                                             Sampler& sampler, Recorder& recorder) {
  if (e.path.bounce < c.path.first_nee_bounce) {
    sampler.start_dimension(kCameraDimensions + e.path.bounce * kDimensionsPerBounce + 1);  // of the next direction
    return {};
  }
  const LightPick pick = pick_light(c.path, sp, sampler);
  if (pick.pmf > 0.0f) recorder.light_picked(sp, e.path, pick.id);
  const LightSample light = sample_picked(c.path, sp, pick);
  if (!light.valid()) return {};
  const Rgb medium = medium_along(c.scene(), sp, light.wi, e.path.medium);
  const BsdfEval bsdf = eval_camera_vertex(c, e, sp, light.wi);
  if (is_black(bsdf.f)) return {};
  const float weight = weight_of_light_connection(c, sp, e, pick, light, bsdf, recorder);
  Connection connection;
  connection.ray = shadow_ray(sp, light);
  connection.light = pick.id;
  connection.contribution = e.path.throughput * bsdf.f * light.radiance * transmittance(medium, light.distance) *
                            (shading_cosine(sp, light.wi) * weight / (pick.pmf * light.pdf_w));
  if (c.scene().disperses) {
    connection.contribution *= dispersion_weight(c.scene(), sp, light.wi, e.path);
    connection.dispersed = e.path.dispersed || disperses(c.scene(), sp, light.wi);
  }
  return connection;
}

/// Weight of a connection along `w`, √distance_squared metres long, to a vertex of the light subpath.
template <typename Recorder = NoRecorder>
RELUME_HD inline float weight_of_vertex_connection(const BdptContext& c, const SurfacePoint& sp, const CameraSubpath& e,
                                                   const BsdfEval& bsdf, const PathVertex& v,
                                                   const AdjointEval& adjoint, const Vec3& w, float distance_squared,
                                                   Recorder&& recorder = Recorder{}) {
  const float found_light = bsdf.pdf_forward * std::fabs(glm::dot(v.ng, w)) / distance_squared;
  const float found_camera = adjoint.pdf_light * std::fabs(glm::dot(sp.ng, w)) / distance_squared;
  const float cuts_at_light = v.weights.sum(found_light, adjoint.pdf_camera, c.merging) / c.connected;
  recorder.weigh(weight_terms(cuts_at_light, found_camera, bsdf.pdf_reverse, e.weights.merging(), 1.0f / c.connected));
  return weight_from(cuts_at_light, e.weights.sum(found_camera, bsdf.pdf_reverse) / c.connected);
}

/// dispersion_weight() of a connection along `w` to a light vertex, whose throughput excludes that factor.
RELUME_HD inline Rgb dispersion_weight(const BdptContext& c, const SurfacePoint& sp, const CameraSubpath& e,
                                       const PathVertex& v, const Vec3& w) {
  if (!e.path.dispersed && v.disperses(-w)) return wavelength_weight(e.path.wavelength_nm);
  return dispersion_weight(c.scene(), sp, w, e.path);
}

/// s ≥ 2: connects to a vertex of the light subpath. `guide`: its guided_point().
template <typename Context, typename Recorder>
RELUME_HD inline Connection connect_to_vertex(const Context& c, const SurfacePoint& sp, const CameraSubpath& e,
                                              const PathVertex& v, const GuidedPoint& guide, Recorder& recorder) {
  const Vec3 d = v.position - sp.position;
  const float distance_squared = length_squared(d);
  if (!(distance_squared > 0.0f)) return {};
  const float distance = std::sqrt(distance_squared);
  const Vec3 w = d / distance;
  const BsdfEval bsdf = eval_camera_vertex(c, e, sp, w);
  if (is_black(bsdf.f)) return {};
  const AdjointEval adjoint = eval_light_vertex(c, v, guide, -w, e.path.wavelength_nm, e.path.ray.time);
  if (is_black(adjoint.f)) return {};
  const float weight = weight_of_vertex_connection(c, sp, e, bsdf, v, adjoint, w, distance_squared, recorder);
  Connection connection;
  connection.ray = shadow_ray(sp, w, distance);
  connection.contribution = e.path.throughput * bsdf.f * v.throughput * adjoint.f *
                            (shading_cosine(sp, w) * std::fabs(glm::dot(v.ng, w)) * weight / distance_squared) *
                            transmittance(medium_along(c.scene(), sp, w, e.path.medium), distance);
  if (c.scene().disperses) {
    connection.contribution *= dispersion_weight(c, sp, e, v, w);
    connection.dispersed = e.path.dispersed || v.disperses(-w) || disperses(c.scene(), sp, w);
  }
  return connection;
}

/// Adds the light of a connection of the last vertex `sp`, which counts `contribution` after roulette, if it is
/// visible.
template <typename Recorder, typename Policy>
RELUME_HD inline void add_tested(const BdptContext& c, const SurfacePoint& sp, const Connection& connection,
                                 const Rgb& contribution, uint32_t ray_id, bool is_visible, CameraSubpath& e,
                                 Recorder& recorder, Policy& policy) {
  if (is_visible) {
    e.path.radiance += contribution;
    recorder.add(contribution, e.weights.at());
    if (e.path.bounce == 0) {
      c.first_light.offer(e.pixel, connection.ray.direction, contribution * unit_of<Policy>(e), ray_id);
    }
  }
  if constexpr (kIsPolicy<Policy>) {
    Connection tested = connection;
    tested.contribution = contribution;
    policy.connected(sp, e.path, tested, is_visible);
  }
}

/// Shows a connection of the last vertex to policies that record samples of indirect light. This precedes roulette:
/// its probability depends on the pixel.
template <typename Policy>
RELUME_HD inline void show_to_samples(Policy& policy, const Connection& connection) {
  if constexpr (kSamplesIndirectLight<Policy>) policy.tried(connection);
}

/// Adds a connection of the last vertex `sp` if roulette selects it and nothing blocks it.
template <typename Recorder, typename Policy>
RELUME_HD inline void try_connection(const BdptContext& c, const SurfacePoint& sp, const Connection& connection,
                                     uint32_t ray_id, CameraSubpath& e, ConnectionRoulette& roulette,
                                     BdptCounters& counters, Recorder& recorder, Policy& policy) {
  if (!connection.valid()) return;
  show_to_samples(policy, connection);
  Rgb contribution = connection.contribution;
  if (!roulette.survives(c, ray_id, contribution, unit_of<Policy>(e))) return;
  const bool is_visible = visible(c, connection.ray, ray_id, counters);
  add_tested(c, sp, connection, contribution, ray_id, is_visible, e, recorder, policy);
}

/// The same for a connection to a light. Roulette leaves it alone where its visibility is recorded.
template <typename Recorder, typename Policy>
RELUME_HD inline void try_light_connection(const BdptContext& c, const SurfacePoint& sp, const Connection& connection,
                                           uint32_t ray_id, CameraSubpath& e, ConnectionRoulette& roulette,
                                           BdptCounters& counters, Recorder& recorder, Policy& policy) {
  if (!recorder.needs_visibility())
    return try_connection(c, sp, connection, ray_id, e, roulette, counters, recorder, policy);
  if (!connection.valid()) return;
  show_to_samples(policy, connection);
  roulette.count(connection.contribution * unit_of<Policy>(e));
  const bool is_visible = visible(c, connection.ray, ray_id, counters);
  recorder.connected(sp, e.path, connection, is_visible);
  add_tested(c, sp, connection, connection.contribution, ray_id, is_visible, e, recorder, policy);
}

/// Tries all connections of the last vertex. `kept`: vertices of the light subpath except the first.
template <typename Context, typename Recorder, typename Policy>
RELUME_HD inline void connect(const Context& c, const SurfacePoint& sp, const KeptVertices& kept, CameraSubpath& e,
                              Sampler& sampler, ConnectionRoulette& roulette, BdptCounters& counters,
                              Recorder& recorder, Policy& policy) {
  const Connection to_light = connect_to_light(c, sp, e, sampler, recorder);
  // Take the identity after the draws for the light. Before, it would equal that of the arriving ray, and partly
  // transparent surfaces would pass both rays or neither.
  const uint32_t ray_id = sampler.ray_id();
  try_light_connection(c, sp, to_light, ray_id, e, roulette, counters, recorder, policy);
  if (leaves_out_surfaces<Policy>(e)) return;
  const uint32_t longest = c.max_bidirectional_vertices();
  for (uint32_t i = 0; i < kept.vertices.size && e.count() + i + 2 <= longest; ++i) {
    const PathVertex& v = kept.vertices[i];
    if (!v.connectable()) continue;
    const Connection to_vertex = connect_to_vertex(c, sp, e, v, kept_guide(c, kept.guides, i), recorder);
    try_connection(c, sp, to_vertex, hash(ray_id, i), e, roulette, counters, recorder, policy);
  }
}

/// Recorder of the subpath's first scattering event, of which reservoirs take candidates. Only where
/// BdptContext::first_scatters is not empty.
RELUME_HD inline FirstScatterPolicy first_scatter_of(const BdptContext& c, const CameraSubpath& e) {
  FirstScatterPolicy policy;
  policy.scatter = &c.first_scatters[e.pixel];
  return policy;
}

/// Samples the next direction. Returns false if the subpath ends here.
template <typename Context, typename Recorder, typename Policy>
RELUME_HD inline bool continue_camera_subpath(const Context& c, const SurfacePoint& sp, CameraSubpath& e,
                                              Sampler& sampler, Recorder& recorder, Policy& policy) {
  const BsdfSample s = c.path.directions.sample(sp, sampler);
  if (!follow(c.path, sp, s, e.path, sampler)) return false;
  if (!c.first_scatters.empty()) first_scatter_of(c, e).scattered(sp, s, e.path);
  const Vec3& wi = e.path.ray.direction;
  const float cosine = std::fabs(glm::dot(sp.ng, wi));
  recorder.scattered(c, sp, s, e.path);
  if constexpr (kSamplesIndirectLight<Policy>) policy.weigh_onwards(e.path, e.weights);
  const GuidedPoint guide = guided_point(c, sp);
  if (e.path.delta) {
    const float ratio = delta_density_ratio(sp, wi) * light_fraction(c, guide) / guide.fraction;
    e.weights.leave_delta(cosine, ratio);
    recorder.left_delta(cosine, ratio);
  } else {
    const float pdf = sampled_pdf(c, s);
    const float reverse = e.weights.at().b > 0.0f ? light_pdf(c, guide, sp.wo, other_sides_pdf(sp, wi)) : 0.0f;
    e.weights.leave(cosine, pdf, reverse);
    recorder.left(cosine, pdf, reverse);
  }
  if constexpr (kIsPolicy<Policy>) {
    PathEvents<SubpathUnits, Recorder> events{e.units, recorder};
    path_policy::scattered(policy, sp, s, e.path, events);
  }
  if (e.path.bounce == 1 && !e.path.delta) {
    e.first_direction = wi;
    e.found_before = found_in_image<Policy>(e);
  }
  return true;
}

/// Whether the subpath only records: light tracing takes no light from beyond its first vertex.
RELUME_HD inline bool only_records(const BdptContext& c, const CameraSubpath& e) {
  return c.light_only && e.path.bounce > 0;
}

/// Whether a subpath of light tracing ends at its last vertex. It continues where it records the importance at
/// `vertex`, the last or the next one, or its first scattering event.
template <typename Recorder>
RELUME_HD inline bool records_no_more(const BdptContext& c, const CameraSubpath& e, const Recorder& recorder,
                                      uint32_t vertex) {
  const bool scatters = e.path.bounce == 0 && !c.first_scatters.empty();
  return c.light_only && !scatters && !recorder.records_importance(vertex);
}

/// Lets the policy see and change the path at the last vertex. Returns false if the subpath ends here.
template <typename Recorder, typename Policy>
RELUME_HD inline bool arrive_with(const BdptContext& c, SurfacePoint& sp, CameraSubpath& e, Recorder& recorder,
                                  Policy& policy) {
  if constexpr (kIsPolicy<Policy>) {
    // As in path tracing, policies see a dispersed path inside a dispersive medium.
    if (c.scene().disperses) disperse(c.scene(), sp, sp.ng, TransportMode::radiance, e.path);
    PathEvents<SubpathUnits, Recorder> events{e.units, recorder};
    return path_policy::arrived(policy, sp, e.path, events);
  } else {
    return true;
  }
}

/// Offers the light that arrived along the direction sampled at the first surface, after the subpath has ended. Light
/// of a sample for reservoirs does not count.
template <typename Policy>
RELUME_HD inline void offer_first_direction(const BdptContext& c, const CameraSubpath& e, const Policy& policy) {
  constexpr uint32_t kId = 0x3c6ef372u;
  if (c.first_light.empty() || length_squared(e.first_direction) == 0.0f) return;
  Rgb found = found_in_image<Policy>(e) - e.found_before;
  if constexpr (kSamplesIndirectLight<Policy>) found = policy.found_beside_sample(e.path, found);
  c.first_light.offer(e.pixel, e.first_direction, found, kId);
}

/// Default of trace_camera_subpath(): nothing besides the connections to one light subpath.
struct OneLightSubpath {
  template <typename Recorder, typename Policy>
  RELUME_HD void add(const BdptContext&, const SurfacePoint&, uint32_t, CameraSubpath&, ConnectionRoulette&,
                     BdptCounters&, Recorder&, Policy&) const {}
};

/// Radiance of the pixel from its camera subpath, starting at the primary hit, with all connections except to the
/// camera. `others`: adds light of other light subpaths at each vertex that does not only scatter specularly. `policy`:
/// its hooks hit_surface(), arrived(), connected(), scattered() and finished() are called as by trace_path(),
/// connected() for every connection and merging. The radiance is that which the policy leaves in the path.
template <typename Context, typename Others, typename Policy>
RELUME_HD inline Rgb trace_camera_subpath(const Context& c, uint32_t x, uint32_t y, Hit hit, const KeptVertices& kept,
                                          Sampler& sampler, ConnectionRoulette& roulette, BdptCounters& counters,
                                          const Others& others, Policy& policy) {
  CameraSubpath e;
  auto recorder = recorder_of(c, y * c.width + x);
  start_camera_subpath(c, x, y, sampler, e);
  ++counters.rays;
  for (;;) {
    if (!hit.valid()) {
      if (!only_records(c, e)) add_met_infinite_lights(c, e, recorder);
      break;
    }
    SurfacePoint sp;
    make_surface_point(c.scene(), e.path.ray, hit, e.path.cone_width + e.path.cone_spread * hit.t, sp,
                       e.path.wavelength_nm);
    absorb(c.scene(), sp, hit.t, e.path);
    recorder.hit_surface(sp, e.path);
    if (!c.first_scatters.empty()) first_scatter_of(c, e).hit_surface(sp, e.path);
    if constexpr (kIsPolicy<Policy>) policy.hit_surface(sp, e.path);
    // A vertex seen edge-on has no density per area, so no weights exist.
    const float cosine = glm::dot(sp.ng, sp.wo);
    if (!(cosine > 0.0f)) break;
    e.weights.arrive(cosine, sqr(hit.t));
    recorder.moved(cosine, sqr(hit.t));
    if (!only_records(c, e)) add_met_emission(c, sp, e, recorder);
    if (e.path.bounce >= c.path.max_bounces || sp.bsdf.empty()) break;
    if (records_no_more(c, e, recorder, e.path.bounce)) break;
    recorder.arrived(sp, e.path);
    // Light tracing does not guide camera subpaths, so their directions have no region. Reservoirs also need the region
    // of a subpath that the policy ends.
    if (!c.first_scatters.empty() && !c.light_only) first_scatter_of(c, e).arrived(sp, e.path);
    if (!arrive_with(c, sp, e, recorder, policy)) break;
    if constexpr (kSamplesIndirectLight<Policy>) policy.weigh_vertex(e.path, e.weights);
    if (records_no_more(c, e, recorder, e.path.bounce + 1)) break;

    sampler.start_dimension(kCameraDimensions + e.path.bounce * kDimensionsPerBounce);
    if (has_non_delta(sp.bsdf) && !c.light_only) {
      connect(c, sp, kept, e, sampler, roulette, counters, recorder, policy);
      others.add(c, sp, sampler.ray_id(), e, roulette, counters, recorder, policy);
    }
    if (!continue_camera_subpath(c, sp, e, sampler, recorder, policy)) break;
    hit = intersect(c.scene(), e.path.ray, ray_id_of(c.path, e.path, sampler));
    ++counters.rays;
  }
  recorder.finished(e.path);
  policy.finished(e.path);
  offer_first_direction(c, e, policy);
  return e.path.radiance;
}

}  // namespace relume
