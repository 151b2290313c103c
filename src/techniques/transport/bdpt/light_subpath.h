// Light subpaths: from a light through the scene. Every vertex is connected to the camera (t = 1), and rays may meet
// the lens (t = 0). Vertices are kept for connections to the camera subpath.
#pragma once

#include "techniques/transport/bdpt/bdpt_context.h"
#include "techniques/transport/bdpt/light_medium.h"

namespace relume {

struct LightSubpath {
  PathState path;  ///< radiance collects only non-finite values; throughput excludes the wavelength weight
  SubpathWeights weights;
  Vec3 from{0};        ///< direction from the last scattering surface vertex to its predecessor; for lens hits
  uint32_t count = 0;  ///< vertices, including that on the light
  bool from_infinity = false;
  bool turned_away = false;               ///< a camera on the ray would look through the last vertex
  bool reservoirs_take_light = false;     ///< whether reservoirs add the light's direct light at primary hits
  bool reservoirs_take_indirect = false;  ///< the same for light of earlier surfaces that scatter by a density
  bool arrived_specularly = false;        ///< whether the last vertex was found by a delta lobe of a surface

  /// Whether reservoirs add the light that the last vertex, a surface, scatters to a camera, except from delta lobes.
  RELUME_HD bool left_to_reservoirs() const {
    return count == 2 ? reservoirs_take_light : reservoirs_take_indirect && !arrived_specularly;
  }
};

/// Samples the first vertex and direction. Returns false if no light can be chosen or the sample carries no light.
RELUME_HD inline bool start_light_subpath(const BdptContext& c, Sampler& sampler, LightSubpath& l) {
  sampler.start_dimension(kLightDimensions);
  const LightSelection selection = c.emission.sample(sampler.reusable(sampler.next_1d()));
  if (!(selection.pmf > 0.0f)) return false;
  const Vec2 u_position = sampler.next_2d();
  const float time = shutter_time(c.scene().camera, sampler);
  const EmissionSample e = sample_le(c.scene().lights, selection.light, u_position, sampler.next_2d(), time);
  if (!e.valid() || !(e.cos_theta > 0.0f)) return false;
  l.path.throughput = e.le * (e.cos_theta / (selection.pmf * e.pdf_a * e.pdf_w));
  l.path.ray = emitted_ray(e, time);
  l.path.cone_spread = 0.0f;
  l.path.wavelength_nm = subpath_wavelength(c, sampler);
  if (!c.light_medium.empty()) l.path.medium = medium_at_light(c.scene(), c.light_medium[selection.light], l.path.ray);
  l.count = 1;
  l.from_infinity = e.infinite;
  l.reservoirs_take_light = c.path.first_nee_bounce > 0 && reservoirs_take(c.scene().lights, selection.light);
  l.reservoirs_take_indirect = c.path.indirect_to_reservoirs;
  // At infinity, the direction is the vertex, and the position belongs to the next vertex.
  const bool can_be_hit = e.infinite ? !e.delta_direction : !e.delta_position;
  const float inverse_density = 1.0f / (selection.pmf * (e.infinite ? e.pdf_w : e.pdf_a));
  const float direct_ratio = weighting_pmf(c, selection.light) / selection.pmf;
  l.weights = SubpathWeights::start(e.infinite ? e.pdf_a : e.pdf_w, can_be_hit ? inverse_density : 0.0f, e.cos_theta,
                                    direct_ratio, e.infinite, c.merging, c.connected);
  return true;
}

/// Weight of a connection to the camera, which finds the last vertex with density `pdf_a` per area. `light_paths`: per
/// pixel.
RELUME_HD inline float weight_of_camera_connection(const LightSubpath& l, const CameraSample& s, const AdjointEval& e,
                                                   float pdf_a, float light_paths = 1.0f) {
  const float lens_met = s.delta ? 0.0f : sqr(e.pdf_light / s.pdf_w);
  return weight_from(l.weights.sum(pdf_a / light_paths, e.pdf_camera), lens_met);
}

/// A connection to the camera, and the raster position of its light.
struct CameraConnection {
  Ray ray;
  Rgb contribution{0};  ///< radiance if the ray is not blocked
  Vec2 raster{0};
  uint32_t ray_id = 0;
  uint32_t from = 0;  ///< octahedral direction from the vertex to its predecessor, if BdptContext::first_light needs it

  RELUME_HD bool valid() const { return !is_black(contribution); }
};

/// Whether a camera in direction `w` looks through the surface, because its back is culled.
RELUME_HD inline bool hidden_from_camera(const SceneView& scene, const SurfacePoint& sp, const Vec3& w) {
  const uint32_t material =
      scene.meshes[scene.instances[sp.instance].mesh].material;  // a mixture decides for its parts
  if (!scene.materials[material].cull_back_faces) return false;
  return (glm::dot(sp.ng, w) > 0.0f) != sp.front_face;
}

/// t = 1: connects the last vertex `sp` to the camera.
template <typename Context>
RELUME_HD inline CameraConnection connect_to_camera(const Context& c, const SurfacePoint& sp, const LightSubpath& l,
                                                    Sampler& sampler) {
  const CameraView camera = camera_at(c.scene().camera, sp.time);
  const Vec2 u_lens = camera.lens_radius > 0.0f ? sampler.next_2d() : Vec2(0);
  const CameraSample s = sample_wi(camera, sp.position, u_lens);
  if (!s.valid()) return {};
  const AdjointEval e = eval_light_vertex(c, sp, s.wi);
  if (is_black(e.f) || hidden_from_camera(c.scene(), sp, s.wi)) return {};
  // Density of this point under camera sampling, per area. Importance is normalised: it is also the measured share.
  const float pdf_a = std::fabs(glm::dot(sp.ng, s.wi)) * s.importance / s.pdf_w;
  const float weight = c.light_only ? 1.0f : weight_of_camera_connection(l, s, e, pdf_a, c.light_paths);
  const Rgb medium = medium_along(c.scene(), sp, s.wi, l.path.medium);
  CameraConnection connection;
  connection.contribution = l.path.throughput * e.f * (pdf_a * weight) * transmittance(medium, s.distance);
  if (l.path.dispersed || disperses(c.scene(), sp, s.wi))
    connection.contribution *= wavelength_weight(l.path.wavelength_nm);
  connection.ray = sp.spawn_ray(s.wi);
  connection.ray.t_max = s.distance;
  connection.raster = s.raster;
  constexpr uint32_t kSalt = 0xffffffffu;  // the continued ray has the plain identity
  connection.ray_id = hash(sampler.ray_id(), kSalt);
  if (!c.first_light.empty()) connection.from = pack_direction(sp.wo);
  return connection;
}

RELUME_HD inline void add_if_visible(const BdptContext& c, const CameraConnection& connection, const Rgb& contribution,
                                     BdptCounters& counters) {
  ++counters.rays;
  if (!occluded_to_camera(c.scene(), connection.ray, connection.ray_id))
    splat(c, connection.raster, contribution, connection.from, connection.ray_id, counters);
}

/// Vertices and camera connections kept until the camera subpath is traced.
struct LightVertices {
  View<PathVertex> vertices;         ///< excludes the vertex on the light; BdptContext::max_kept_vertices() elements
  View<CameraConnection> to_camera;  ///< as many; empty: connections to the camera are tested immediately
  uint32_t count = 0;                ///< of the vertices
  uint32_t connections = 0;          ///< of those to the camera
  View<GuidedPoint> guides = {};     ///< of the vertices, as many; empty: camera subpaths are not guided

  RELUME_HD KeptVertices view() const { return {{vertices.data, count}, {guides.data, guides.empty() ? 0u : count}}; }
};

/// Memory for the longest light subpath, 4.6 KB.
struct LightVertexArrays {
  PathVertex vertices[kMaxLightVertices - 1];
  CameraConnection to_camera[kMaxLightVertices - 1];

  LightVertices view() { return {{vertices, kMaxLightVertices - 1}, {to_camera, kMaxLightVertices - 1}}; }
};

/// Tests the connections to the camera. `tried`: roulette of the camera subpath. Each connection is compared with those
/// of the camera subpath only, since the others arrive at other pixels.
RELUME_HD inline void try_camera_connections(const BdptContext& c, const LightVertices& light,
                                             const ConnectionRoulette& tried, BdptCounters& counters) {
  for (uint32_t i = 0; i < light.connections; ++i) {
    ConnectionRoulette roulette = tried;
    Rgb contribution = light.to_camera[i].contribution;
    if (roulette.survives(c, light.to_camera[i].ray_id, contribution))
      add_if_visible(c, light.to_camera[i], contribution, counters);
  }
}

/// Intersection of a ray with the lens from the front: raster position and distance.
struct LensHit {
  Vec2 raster{0};
  float distance = kInfinity;
  float importance = 0;
  float cosine = 0;
};

RELUME_HD inline LensHit meet_lens(const CameraView& scene_camera, const Ray& ray) {
  if (scene_camera.projection != Projection::perspective || scene_camera.lens_radius == 0.0f) return {};
  const CameraView c = camera_at(scene_camera, ray.time);
  const float cosine = glm::dot(ray.direction, c.axes.n);
  if (cosine <= 0.0f) return {};
  const float distance = glm::dot(c.position - ray.origin, c.axes.n) / cosine;
  if (distance <= 0.0f) return {};
  const Ray out{ray.origin + distance * ray.direction, -ray.direction, kInfinity};
  if (length_squared(out.origin - c.position) >= sqr(c.lens_radius)) return {};
  LensHit hit;
  if (!raster_position(c, out, &hit.raster)) return {};
  hit.distance = distance;
  hit.importance = we(c, out);
  hit.cosine = cosine;
  return hit;
}

RELUME_HD inline float weight_of_lens_hit(const BdptContext& c, const LightSubpath& l, const LensHit& hit) {
  const CameraView& camera = c.scene().camera;
  SubpathWeights weights = l.weights;
  PartialWeights at_lens = weights.arrive(hit.cosine, sqr(hit.distance));
  // Only connections to the camera come from as many light subpaths.
  at_lens.a /= c.connected;
  const float onwards = hit.importance * camera.lens_area() * hit.cosine / c.light_paths;
  return weight_from(at_lens.sum(1.0f / camera.lens_area(), onwards), 0.0f);
}

/// t = 0: adds the radiance of a ray that met the lens.
RELUME_HD inline void add_lens_hit(const BdptContext& c, const LensHit& hit, const LightSubpath& l,
                                   BdptCounters& counters) {
  const float weight = weight_of_lens_hit(c, l, hit);
  Rgb light = l.path.throughput * transmittance(l.path.medium, hit.distance) * (hit.importance * weight);
  if (l.path.dispersed) light *= wavelength_weight(l.path.wavelength_nm);
  const uint32_t from = c.first_light.empty() ? 0u : pack_direction(l.from);
  splat(c, hit.raster, light, from, hash(float_bits(hit.raster.x), float_bits(hit.raster.y)), counters);
}

/// Whether the camera sees the last vertex through the lens. `hit`: nearest hit of the ray, ignoring the lens.
RELUME_HD inline bool seen_through_lens(const BdptContext& c, const LensHit& lens, const Hit& hit, uint32_t ray_id,
                                        const LightSubpath& l) {
  if (!(lens.importance > 0.0f) || l.turned_away) return false;
  if (lens.distance < hit.t) return true;
  if (!c.scene().culls_back_faces) return false;
  Ray ray = l.path.ray;
  ray.t_max = lens.distance;
  return !occluded_to_camera(c.scene(), ray, ray_id);
}

/// Samples the next direction. Returns false if the subpath ends here. The reverse density includes guiding, as camera
/// subpaths would sample the directions.
template <typename Context>
RELUME_HD inline bool continue_light_subpath(const Context& c, const SurfacePoint& sp, LightSubpath& l,
                                             Sampler& sampler) {
  if (bent(sp)) return false;
  BsdfSample s = c.path.directions.sample(sp, sampler, TransportMode::importance);
  if (!s.valid || !same_shading_frame(sp, s.wi)) return false;
  s.weight *= adjoint_correction(sp, s.wi);
  l.from = sp.wo;
  l.turned_away = hidden_from_camera(c.scene(), sp, s.wi);
  const float cosine = std::fabs(glm::dot(sp.ng, s.wi));
  const GuidedPoint guide = guided_point(c, sp);
  if (s.delta) {
    l.weights.leave_delta(cosine, delta_density_ratio(sp, s.wi) * guide.fraction / light_fraction(c, guide));
  } else {
    l.weights.leave(cosine, sampled_pdf(c, s), camera_pdf(c, guide, sp.wo, other_sides_pdf(sp, s.wi)));
  }
  return follow(c.path, sp, s, l.path, sampler, TransportMode::importance);
}

/// Moves the subpath to `hit`, its next vertex. Returns false if the subpath cannot continue there.
template <typename Context>
RELUME_HD inline bool arrive(const Context& c, const Hit& hit, LightSubpath& l, SurfacePoint& sp) {
  make_surface_point(c.scene(), l.path.ray, hit, 0.0f, sp, l.path.wavelength_nm);
  const float cosine = glm::dot(sp.ng, sp.wo);
  if (!(cosine > 0.0f) || sp.bsdf.empty()) return false;
  find_region(c, sp);
  // Light from infinity has no known point of entry, so nothing absorbs it there, as on camera subpaths.
  absorb(c.scene(), sp, l.from_infinity && l.count == 1 ? kInfinity : hit.t, l.path);
  l.weights.arrive(cosine, sqr(hit.t));
  l.arrived_specularly = l.path.delta && l.count > 1;
  ++l.count;
  return true;
}

/// Wavelength dependence of the light that leaves the last vertex.
RELUME_HD inline Dispersion dispersion_behind(const BdptContext& c, const SurfacePoint& sp, const LightSubpath& l) {
  return l.path.dispersed ? Dispersion::always : dispersion_at(c.scene(), sp);
}

/// Traces a whole light subpath. Stores vertex i ≥ 1 (0 is the light) in kept.vertices[i - 1], with its connection to
/// the camera. Light tracing stores none. It adds its connections immediately, as without memory for them.
template <typename Context>
RELUME_HD inline void trace_light_subpath(const Context& c, Sampler& sampler, LightVertices& kept,
                                          BdptCounters& counters) {
  const uint32_t max_count = c.max_bidirectional_vertices() - 1;
  LightSubpath l;
  if (max_count < 2 || !start_light_subpath(c, sampler, l)) return;
  const bool lens = !c.light_only && c.scene().camera.lens_radius > 0.0f;
  const bool at_once = c.light_only || kept.to_camera.empty();
  for (;;) {
    const bool meets_lens = lens && l.count > 1 && (l.path.delta || !l.left_to_reservoirs());
    const LensHit lens_hit = meets_lens ? meet_lens(c.scene().camera, l.path.ray) : LensHit{};
    if (l.count == max_count) {  // only the lens may follow
      l.path.ray.t_max = lens_hit.distance;
      if (lens_hit.importance > 0.0f && !l.turned_away) {
        ++counters.rays;
        if (!occluded_to_camera(c.scene(), l.path.ray, sampler.ray_id())) add_lens_hit(c, lens_hit, l, counters);
      }
      break;
    }
    const Hit hit = intersect(c.scene(), l.path.ray, sampler.ray_id());
    ++counters.rays;
    if (seen_through_lens(c, lens_hit, hit, sampler.ray_id(), l)) add_lens_hit(c, lens_hit, l, counters);
    SurfacePoint sp;
    if (!hit.valid() || !arrive(c, hit, l, sp)) break;
    sampler.start_dimension(kLightDimensions + l.count * kLightDimensionsPerVertex);
    if (has_non_delta(sp.bsdf) && !l.left_to_reservoirs()) {
      const CameraConnection connection = connect_to_camera(c, sp, l, sampler);
      if (connection.valid() && at_once) add_if_visible(c, connection, connection.contribution, counters);
      if (connection.valid() && !at_once) kept.to_camera[kept.connections++] = connection;
    }
    if (!c.light_only) {
      if (Context::kLearns && !kept.guides.empty()) kept.guides[kept.count] = guided_point(c, sp);
      kept.vertices[kept.count++] =
          make_path_vertex(sp, l.path.throughput, l.weights.at(), dispersion_behind(c, sp, l));
    }
    if (l.count == max_count && !lens) break;
    if (!continue_light_subpath(c, sp, l, sampler)) break;
  }
  if (!is_finite(l.path.radiance)) ++counters.nonfinite;  // non-finite throughput that ended the subpath
}

}  // namespace relume
