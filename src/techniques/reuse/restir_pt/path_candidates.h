// First kernel of ReSTIR PT: traces one path per pixel, and keeps one of the paths to light that it contains, by
// resampling with their luminances as weights ([Lin22]).
#pragma once

#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/reuse/restir_pt/learned_choices.h"
#include "techniques/reuse/restir_pt/path_shift.h"
#include "techniques/reuse/restir_pt/path_suffix.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/specular_part.h"

namespace relume {

/// The first joint along a path that is being traced.
struct TracedJoint {
  uint32_t vertex = 0;  ///< 0: none yet
  Hit hit;
  Vec3 leaving{0};
  Rgb medium{0};
  Rgb suffix{1};           ///< throughput after the joint, with the transmittance along `leaving`
  float density = 0;       ///< density of the path's coordinates at the joint: area times solid angle
  bool disperses = false;  ///< whether a vertex after the joint scatters by wavelength
};

/// Traces a path from its primary hit, and chooses one of its contributions. `Choices`: FixedPath or LearnedPath.
/// `Suffix`: how it finds the light behind the vertex after its joint (path_suffix.h).
template <typename Choices, typename Suffix>
struct CandidateTracer {
  const PathContext& context;
  const ConnectRule& rule;
  const Suffix& behind;
  const SampleIndex& index;
  uint32_t x;
  uint32_t y;
  PathWalk& walk;  ///< started
  Sampler& sampler;
  ChoiceNumbers& numbers;
  float indirect_weight = 1;  ///< IndirectRate::weight() of the pixel
  StoredPath chosen;          ///< begins with the identity of the random numbers
  Choices choices;
  float target = 0;  ///< p̂ of the chosen path
  WeightedChoice choice = {};
  TracedJoint joint = {};
  Hit hit;          ///< of the current vertex
  Vec3 first{0};    ///< StoredPath::first
  float scale = 1;  ///< one over the probability with which the walk has survived
  uint32_t rays = 0;
  FirstVertex* first_vertex = nullptr;  ///< record of the primary hit, empty at the start; nullptr: none

  RELUME_HD void trace() {
    const SceneView& scene = context.scene;
    while (!walk.sp.bsdf.empty() && walk.path.bounce < context.max_bounces) {
      choices.arrived(walk);
      connect_to_light();
      const BsdfSample s = choices.sample(context, rule, walk, joint.vertex > 0, sampler);
      if (!scatter(s)) return;
      const Hit next = intersect(scene, walk.path.ray, sampler.ray_id());
      ++rays;
      if (!next.valid()) return add_infinity();
      const float pmf = walk.path.delta ? 0.0f : choices.pmf_of_hit(context, walk, next, leaves_stored());
      const Vec3 previous = walk.sp.position;
      const Rgb leaving = walk.path.throughput;
      hit = next;
      joint.suffix *= arrive(scene, hit, walk);
      choices.hit_surface(walk);
      add_emitter(previous, pmf);
      choices.met_emitter(walk);
      if constexpr (Suffix::uses_cells) {
        if (ends_cached()) return add_cached(leaving);
      }
      enter(scene, walk);
      if (joint.vertex > 0) joint.disperses = joint.disperses || disperses(scene, walk.sp, walk.sp.ng);
    }
  }

 private:
  /// Whether a contribution replaces the chosen one. `value`: light in the image, without `scale`. `connects()`: as in
  /// FixedPath::weight().
  template <typename Connects>
  RELUME_HD bool offer(const Rgb& value, const Connects& connects) {
    const float weight = scale * choices.weight(connects);
    choices.add(walk, value * weight);
    return choice.offer(luminance(value) * weight, numbers.next());
  }

  /// Whether the path's ray leaves a vertex past the joint.
  RELUME_HD bool leaves_stored() const { return joint.vertex > 0 && walk.path.bounce > joint.vertex + 1; }

  /// Stores the chosen path. `value`: light in the image. `density`: of the path's coordinates. Other members are set.
  RELUME_HD void store(PathEnd end, uint32_t joint_vertex, bool disperses, const Rgb& value, float density) {
    const uint32_t length = end == PathEnd::connection ? walk.path.bounce + 1 : walk.path.bounce;
    chosen.shape = StoredPath::shape_of(end, length, joint_vertex, disperses);
    chosen.value = value * density;
    chosen.first = first;
    target = luminance(chosen.value);
  }
  RELUME_HD void store_surface(const Hit& at) {
    chosen.instance = at.instance;
    chosen.primitive = at.primitive;
    chosen.u = at.u;
    chosen.v = at.v;
  }
  RELUME_HD void clear_joint() {
    store_surface({});
    chosen.u = chosen.v = 0;
    chosen.leaving = Vec3(0);
    chosen.light = kNoLight;
    chosen.light_pdf_w = 0;
    chosen.suffix = Rgb(0);
    chosen.medium = Rgb(0);
  }
  /// Stores the joint that the path has passed.
  RELUME_HD void store_joint(const Rgb& suffix) {
    store_surface(joint.hit);
    chosen.leaving = joint.leaving;
    chosen.medium = joint.medium;
    chosen.suffix = suffix;
  }

  /// Next event estimation at the current vertex.
  RELUME_HD void connect_to_light() {
    const SurfacePoint& sp = walk.sp;
    const SceneView& scene = context.scene;
    const bool past_joint = joint.vertex > 0;
    const LightPick pick = choices.pick(context, walk, past_joint, sampler);
    if (pick.pmf > 0.0f) choices.light_picked(walk, pick.id);
    const LightSample light = sample_picked(context, sp, pick);
    if (!light.valid()) return;
    const BsdfEval bsdf = eval_pdf(sp, light.wi);
    if (is_black(bsdf.f)) return;
    const float mis = choices.light_weight(context, walk, past_joint, pick, light, bsdf);
    const Rgb reflected = reflected_light(scene, sp, walk.path.medium, light, bsdf) * (mis / pick.pmf);
    const bool scatters_by_wavelength = disperses(scene, sp, light.wi);
    const Rgb weight =
        walk.path.dispersed || scatters_by_wavelength ? wavelength_weight(walk.path.wavelength_nm) : Rgb(1);
    const Rgb value = walk.path.throughput * reflected * weight;
    if (is_black(value)) return;
    ++rays;
    const bool visible = !occluded(scene, shadow_ray(sp, light), sampler.ray_id());
    choices.connected(walk, pick.id, value, scale, visible);
    if (walk.path.bounce == 0) {
      first = light.wi;
      if (first_vertex) record_light(pick, light, mis / pick.pmf, visible);
    }
    if (!visible) return;
    const auto connects = [&] { return connects_here(bsdf); };
    if (offer(value, connects))
      store_connection(pick, light, bsdf, value, joint.suffix * reflected, scatters_by_wavelength);
  }

  /// Whether the current vertex, which reflects a connected light, and the one before it are connectible.
  RELUME_HD bool connects_here(const BsdfEval& bsdf) const {
    const SegmentEnd here{bsdf.pdf_forward, narrowest_alpha(walk.sp.bsdf), walk.cosine, false};
    return walk.path.bounce > 0 && rule.connects(walk.from, here, walk.distance, walk.footprint);
  }

  /// Records the light sample of the primary hit, without light: the chosen path has all of it.
  RELUME_HD void record_light(const LightPick& pick, const LightSample& light, float light_scale, bool visible) const {
    first_vertex->to_light = light.wi;
    first_vertex->light = pick.id;
    first_vertex->light_u = pick.u;
    first_vertex->light_scale = light_scale;
    const float factor = visible ? shading_cosine(walk.sp, light.wi) / light.pdf_w : 0.0f;
    first_vertex->light_value = luminance(light.radiance * factor);
  }

  RELUME_HD void store_connection(const LightPick& pick, const LightSample& light, const BsdfEval& bsdf,
                                  const Rgb& value, const Rgb& suffix, bool scatters_by_wavelength) {
    const SurfacePoint& sp = walk.sp;
    const uint32_t vertex = walk.path.bounce;
    clear_joint();
    if (joint.vertex > 0) {
      store_joint(suffix);
      return store(PathEnd::connection, joint.vertex, joint.disperses || scatters_by_wavelength, value, joint.density);
    }
    const LightPoint point = point_of(context.scene.lights, pick.id, light);
    chosen.light = point.light;
    chosen.leaving = Vec3(point.coordinates.x, point.coordinates.y, 0);
    // One over the density of the coordinates, in the measure of light_at().
    const float unit = light_at(context.scene.lights, point, sp.position).pdf_w;
    const float density = pick.pmf * light.pdf_w / unit;
    if (!connects_here(bsdf)) return store(PathEnd::connection, vertex + 1, false, value, density);
    store_surface(hit);
    chosen.medium = medium_along(context.scene, sp, light.wi, walk.path.medium);
    store(PathEnd::connection, vertex, false, value, walk.from.pdf_w * walk.geometry() * density);
  }

  /// Leaves the current vertex, by Russian roulette as path tracing. Returns false if the path ends there.
  RELUME_HD bool scatter(const BsdfSample& s) {
    if (!s.valid) return false;
    const SceneView& scene = context.scene;
    const uint32_t vertex = walk.path.bounce;
    if (vertex == 0 && first_vertex && !s.delta) first_vertex->scatter = s.wi;
    if (!s.delta && !walk.path.indirect) {
      if (indirect_weight == 0.0f) return false;
      scale *= indirect_weight;
    }
    if (vertex == 0) first = s.delta ? Vec3(0) : s.wi;
    const SegmentEnd before = walk.from;
    const bool passed = joint.vertex > 0;
    if (passed) {
      joint.suffix *= s.weight;
      joint.disperses = joint.disperses || disperses(scene, walk.sp, s.wi);
    }
    leave(scene, s, walk);
    if (!passed && vertex > 0) find_joint(vertex, before, s);
    if (!passed && !choices.settle(joint.vertex > 0)) return false;
    const Rgb& throughput = walk.path.throughput;
    const float sum = throughput.r + throughput.g + throughput.b;
    if (!(sum > 0.0f)) {
      if (!is_finite(sum)) choice.sum = sum;  // is counted there
      return false;
    }
    if (!survives(vertex)) return false;
    choices.scattered(walk, s, passed, scale);
    return true;
  }

  /// Makes vertex `vertex`, which the path leaves by `s`, the joint if it is connectible to the one before it.
  RELUME_HD void find_joint(uint32_t vertex, const SegmentEnd& before, const BsdfSample& s) {
    const SegmentEnd here{s.pdf_w, walk.from.alpha, walk.cosine, s.delta};
    if (!rule.connects(before, here, walk.distance, walk.footprint)) return;
    joint.vertex = vertex;
    joint.hit = hit;
    joint.leaving = s.wi;
    joint.medium = walk.path.medium;
    joint.suffix = Rgb(1);
    joint.density = before.pdf_w * walk.geometry() * s.pdf_w;
    end_cone(walk);
  }

  RELUME_HD bool survives(uint32_t vertex) {
    PathState& path = walk.path;
    if (vertex == 0) {
      path.rr_reference = max_component(path.throughput) * scale / path.eta_scale;
    } else if (context.russian_roulette) {
      const float survival =
          kRouletteThreshold * max_component(path.throughput) * scale / (path.eta_scale * path.rr_reference);
      if (survival < 1.0f) {
        if (sampler.next_1d() >= survival) return false;
        scale /= survival;
      }
    }
    return true;
  }

  /// Emission at the current vertex, where the path has arrived from `previous`. `pmf`: of selecting its light there.
  RELUME_HD void add_emitter(const Vec3& previous, float pmf) {
    const SurfacePoint& sp = walk.sp;
    const PathState& path = walk.path;
    if (!path.indirect || is_black(sp.emission)) return;
    const bool selectable = !path.delta && sp.light != kNoLight;
    const float pdf =
        selectable ? pdf_li(context.scene.lights, sp.light, previous, path.ray.direction, sp.emitter_point()) : 0.0f;
    const float mis = selectable ? scatter_weight(path.pdf_w, pmf, pdf) : 1.0f;
    const Rgb value = path.throughput * sp.emission * walk.dispersion() * mis;
    const auto connects = [&] { return rule.connects_to_end(walk.from, walk.cosine, walk.distance, walk.footprint); };
    if (!offer(value, connects)) return;
    clear_joint();
    if (joint.vertex > 0) {
      const bool is_last = joint.vertex + 1 == path.bounce;
      store_joint(joint.suffix * sp.emission * (is_last ? 1.0f : mis));
      if (is_last && selectable) chosen.light = sp.light;
      if (is_last) chosen.light_pdf_w = pdf;
      return store(PathEnd::emitter, joint.vertex, joint.disperses, value, joint.density);
    }
    if (!connects()) return store(PathEnd::emitter, 0, false, value, 1.0f);
    store_surface(hit);
    store(PathEnd::emitter, path.bounce, false, value, walk.from.pdf_w * walk.geometry());
  }

  /// Whether the light that the current vertex reflects comes from the cache: shifts keep it, and no vertex before
  /// scatters by wavelength. The same test as PathShifter::ends_cached().
  RELUME_HD bool ends_cached() const {
    return joint.vertex > 0 && walk.path.bounce == joint.vertex + 1 && !walk.path.dispersed;
  }

  /// Light that the current vertex, the first after the joint, reflects. `leaving`: throughput of the path there,
  /// without transmittance.
  RELUME_HD void add_cached(const Rgb& leaving) {
    const Rgb light = joint.suffix * light_behind();
    rays += walk.path.rays;
    const float weight = scale * choices.weight([] { return true; });
    if (!choice.offer(cached_target(leaving, light) * weight, numbers.next())) return;
    clear_joint();
    store_joint(light);
    chosen.shape = StoredPath::shape_of(PathEnd::cached, joint.vertex + 2, joint.vertex, false);
    chosen.value = leaving * light * joint.density;
    chosen.first = first;
    target = cached_target(leaving * joint.density, light);
  }

  /// Radiance that the current vertex reflects to the joint, and the end of the path. Not inlined, to bound the stack
  /// of kernels.
  RELUME_HD_NOINLINE Rgb light_behind() {
    typename Suffix::Policy cache = behind.policy(index, x, y, walk.from.alpha);
    auto policy = choices.enter_cells(walk, scale, cache);
    return relume::light_behind(context, walk, sampler, policy);
  }

  /// Light from infinity along the path's ray, which left the scene.
  RELUME_HD void add_infinity() {
    const PathState& path = walk.path;
    if (!path.indirect) return;
    const Rgb light = choices.light_from_infinity(context, walk, leaves_stored());
    const Rgb value = path.throughput * light * walk.dispersion();
    if (is_black(value)) return;
    const auto connects = [&] { return rule.connects_to_end(walk.from, 1.0f, kInfinity, walk.footprint); };
    const bool chooses = offer(value, connects);
    choices.met_infinity(walk);
    if (!chooses) return;
    clear_joint();
    if (joint.vertex > 0) {
      store_joint(joint.suffix * light);
      return store(PathEnd::infinity, joint.vertex, joint.disperses, value, joint.density);
    }
    if (!connects()) return store(PathEnd::infinity, 0, false, value, 1.0f);
    chosen.leaving = path.ray.direction;
    store(PathEnd::infinity, path.bounce, false, value, path.pdf_w);
  }
};

/// `Choices`: FixedChoices or LearnedChoices. `Suffix`: of path_suffix.h.
template <typename Choices, typename Suffix>
struct PathCandidateKernel {
  PathContext context;  ///< FixedChoices: that of shifts
  ConnectRule rule;
  SampleIndex index;
  View<const Hit> hits;
  View<PathReservoir> reservoirs;
  View<ReceiverRecord> records;
  View<FirstVertex> first_vertices;  ///< receives the directions sampled at the primary hit; may be empty
  ReuseImage image;
  uint32_t width = 0;
  bool has_cones = false;  ///< whether vertices up to the joint read textures by ray cones
  Choices choices;
  Suffix suffix = {};

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    reservoirs[pixel] = {};
    records[pixel] = {};
    if (!image.sampled.has(pixel) || !hits[pixel].valid() || context.max_bounces == 0) return choices.leave_out(pixel);
    Sampler sampler = index.sampler(x, y);
    records[pixel] = record_of(context.scene, x, y, sampler, hits[pixel]);
    PathWalk walk;
    walk.has_cone = has_cones;
    const ReceiverRecord& record = records[pixel];
    const Instance& instance = context.scene.instances[record.hit.instance];
    if (!start_walk(context.scene, context.scene.camera, instance, record, record.wavelength_nm, walk))
      return choices.leave_out(pixel);
    ChoiceNumbers numbers(index.seed, index.frame, pixel, kChoosesPaths);
    CandidateTracer<typename Choices::template Path<Suffix::uses_cells>, Suffix> tracer{
        .context = context,
        .rule = rule,
        .behind = suffix,
        .index = index,
        .x = x,
        .y = y,
        .walk = walk,
        .sampler = sampler,
        .numbers = numbers,
        .indirect_weight = context.indirect.weight(x, y),
        .chosen = {.pixel = pixel, .seed = index.seed, .sequence = index.sequence, .element = index.sample_of(x, y)},
        .choices = choices.template begin<Suffix::uses_cells>(pixel),
        .hit = record.hit,
        .first_vertex = first_vertices.empty() ? nullptr : &first_vertices[pixel]};
    tracer.trace();
    tracer.choices.finished(walk);
    image.rays[pixel] += tracer.rays;
    finish(pixel, tracer);
  }

 private:
  template <typename Tracer>
  RELUME_HD void finish(uint32_t pixel, const Tracer& tracer) const {
    PathReservoir own;
    own.confidence = 1;
    if (!is_finite(tracer.choice.sum)) {
      image.radiance[pixel] += Rgb(tracer.choice.sum);  // is counted there, and must not spread
    } else if (tracer.chosen.valid()) {
      own.sample = tracer.chosen;
      own.target = tracer.target;
      own.weight = own.target > 0.0f ? tracer.choice.sum / own.target : 0.0f;
      if (!is_finite(own.weight) || !is_finite(own.target)) own.weight = own.target = 0.0f;
    }
    reservoirs[pixel] = own;
  }
};

}  // namespace relume
