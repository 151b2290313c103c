// Shifts a stored path to another pixel or frame: random replay, reconnection and their hybrid ([Lin22]).
#pragma once

#include "techniques/reuse/restir_pt/path_walk.h"

namespace relume {

/// What became of a shift. Each undefined result is found in both directions, because it is a property of the shifted
/// path: the path has no preimage there.
enum class ShiftResult : uint32_t {
  defined,
  ended,        ///< the replayed path ends early, or meets no light
  too_early,    ///< vertices before the joint are connectible: the shifted path would have another joint
  no_joint,     ///< the vertices at the joint are not connectible
  other_media,  ///< other media lie behind the joint
  other_end,    ///< one of both paths has light of a radiance cache behind the joint, and the other has not
  occluded,
  dark,  ///< a surface reflects nothing, or the value is not finite
};
inline constexpr uint32_t kShiftResults = 8;

/// p̂ of a path whose light behind the joint comes from a cache. `reflected`: integrand for a white light. The quotient
/// of two pixels' p̂ is the same for any light, so their weights are exact even if its distribution differs among pixels
/// and frames, as with cells.
RELUME_HD inline float cached_target(const Rgb& reflected, const Rgb& light) {
  return luminance(reflected) * luminance(light);
}

struct Shifted {
  Rgb value{0};       ///< integrand at the shifted path; black unless defined
  float target = 0;   ///< p̂: luminance of the value, or cached_target()
  Vec3 first{0};      ///< as StoredPath::first
  float density = 1;  ///< of the shifted path's coordinates at the joint, by the shifted path's sampling
  ShiftResult result = ShiftResult::ended;
};

/// Gives the reservoir's path the value that it has in another domain.
RELUME_HD inline void move_to(const Shifted& shifted, StoredPath& path) {
  path.value = shifted.value;
  path.first = shifted.first;
}

struct PathShifter {
  PathContext context;
  ConnectRule rule;
  SampleIndex index;  ///< of this frame
  uint32_t width = 0;
  bool has_cones = false;   ///< whether vertices up to the joint read textures by ray cones
  bool uses_cells = false;  ///< whether candidates find light behind joints by a radiance cache

  /// Shifts `stored`, which exists(), to the primary hit of a record. `camera`: that of its frame. `instance`: of the
  /// hit, as placed in that frame. `traced`: whether to test the segment to the joint for occlusion. Adds traced rays
  /// to `rays`.
  RELUME_HD_NOINLINE Shifted shift(const StoredPath& stored, const CameraView& camera, const Instance& instance,
                                   const ReceiverRecord& record, bool traced, uint32_t& rays) const {
    Shifted out;
    Task t{stored, sampler_of(index, width, stored), {}, out, rays, traced};
    const SceneView& scene = context.scene;
    t.walk.has_cone = has_cones;
    if (!start_walk(scene, camera, instance, record, path_wavelength(scene, t.sampler), t.walk)) return out;
    const uint32_t last = stored.joint() > 0 ? stored.joint() : stored.length();
    while (t.walk.path.bounce + 1 < last) {
      if (!advance(t)) return out;
    }
    finish(t);
    return out;
  }

 private:
  /// One shift. References live as long as the call of shift().
  struct Task {
    const StoredPath& stored;
    Sampler sampler;
    PathWalk walk;
    Shifted& out;
    uint32_t& rays;
    bool traced;

    RELUME_HD bool fail(ShiftResult result) const {
      out.result = result;
      return false;
    }
    /// Completes the shift. `value`: without throughput of the walk. `dispersed`: whether a vertex scatters by
    /// wavelength.
    RELUME_HD void complete(const Rgb& value, bool dispersed, float density) const {
      const PathState& path = walk.path;
      const Rgb weight = dispersed ? wavelength_weight(path.wavelength_nm) : Rgb(1);
      const Rgb all = path.throughput * value * weight;
      set(all, luminance(all), density);
    }
    /// The same for a cached end. `value`: without its light.
    RELUME_HD void complete_cached(const Rgb& value, float density) const {
      const Rgb reflected = walk.path.throughput * value;
      set(reflected * stored.suffix, cached_target(reflected, stored.suffix), density);
    }

   private:
    RELUME_HD void set(const Rgb& value, float target, float density) const {
      const bool positive = is_finite(value) && is_finite(target) && target > 0.0f;
      out.value = positive ? value : Rgb(0);
      out.target = positive ? target : 0.0f;
      out.density = density;
      out.result = positive ? ShiftResult::defined : ShiftResult::dark;
    }
  };

  RELUME_HD void finish(Task& t) const {
    const StoredPath& stored = t.stored;
    if (stored.joint() == 0) return replay_end(t);
    if (stored.joint() < stored.length()) return connect_to_vertex(t);
    switch (stored.end()) {
      case PathEnd::connection: return connect_to_light(t);
      case PathEnd::emitter: return connect_to_emitter(t);
      case PathEnd::infinity: return connect_to_infinity(t);
      case PathEnd::cached:
      case PathEnd::none: break;
    }
  }

  /// Whether the last two vertices may be passed, with a direction of this density from the current one.
  RELUME_HD bool passes(const Task& t, float pdf_w, bool delta) const {
    if (t.walk.path.bounce == 0) return true;
    const SegmentEnd here{pdf_w, narrowest_alpha(t.walk.sp.bsdf), t.walk.cosine, delta};
    return !rule.connects(t.walk.from, here, t.walk.distance, t.walk.footprint);
  }

  /// Leaves the current vertex by the path's random numbers.
  RELUME_HD bool replay_direction(Task& t) const {
    PathWalk& w = t.walk;
    skip_light(w, t.sampler);
    const BsdfSample s = context.directions.sample(w.sp, t.sampler);
    if (!s.valid) return t.fail(ShiftResult::ended);
    if (!passes(t, s.pdf_w, s.delta)) return t.fail(ShiftResult::too_early);
    if (w.path.bounce == 0) t.out.first = s.delta ? Vec3(0) : s.wi;
    leave(context.scene, s, w);
    return true;
  }

  RELUME_HD Hit trace(Task& t) const {
    ++t.rays;
    return intersect(context.scene, t.walk.path.ray, t.sampler.ray_id());
  }

  /// Replays the path up to the next vertex.
  RELUME_HD bool advance(Task& t) const {
    if (!replay_direction(t)) return false;
    const Hit hit = trace(t);
    if (!hit.valid()) return t.fail(ShiftResult::ended);
    arrive(context.scene, hit, t.walk);
    enter(context.scene, t.walk);
    return !t.walk.sp.bsdf.empty() || t.fail(ShiftResult::ended);
  }

  /// Replays the last direction of a path without a joint.
  RELUME_HD void replay_end(Task& t) const {
    PathWalk& w = t.walk;
    if (!replay_direction(t)) return;
    const Hit hit = trace(t);
    const bool meets_surface = t.stored.end() == PathEnd::emitter;
    t.out.result = ShiftResult::ended;
    if (hit.valid() != meets_surface || !w.path.indirect) return;
    if (!meets_surface) {
      if (rule.connects_to_end(w.from, 1.0f, kInfinity, w.footprint)) return void(t.fail(ShiftResult::too_early));
      const Vec3& wi = w.path.ray.direction;
      return t.complete(light_from_infinity(context, w.sp, wi, w.path.pdf_w, w.path.delta), w.path.dispersed, 1.0f);
    }
    const float pmf = w.path.delta ? 0.0f : pmf_of_hit(context, w.sp, hit);
    const Vec3 previous = w.sp.position;
    arrive(context.scene, hit, w);
    if (is_black(w.sp.emission)) return;
    if (rule.connects_to_end(w.from, w.cosine, w.distance, w.footprint)) return void(t.fail(ShiftResult::too_early));
    t.complete(emitted(t, previous, pmf, w.path.pdf_w, w.path.delta), w.path.dispersed, 1.0f);
  }

  /// Emission of the current surface towards `previous`, from where a direction of density `pdf_w` was sampled, with
  /// its MIS weight. `pmf`: of selecting the surface's light there.
  RELUME_HD Rgb emitted(const Task& t, const Vec3& previous, float pmf, float pdf_w, bool delta) const {
    const SurfacePoint& sp = t.walk.sp;
    if (delta || sp.light == kNoLight || !(pmf > 0.0f)) return sp.emission;
    const float pdf = pdf_li(context.scene.lights, sp.light, previous, -sp.wo, sp.emitter_point());
    return sp.emission * scatter_weight(pdf_w, pmf, pdf);
  }

  /// Evaluates the BSDF of the last replayed vertex towards `wi`. Returns false if the path cannot leave it so.
  RELUME_HD bool leaves_towards(Task& t, const Vec3& wi, BsdfEval& bsdf) const {
    bsdf = eval_pdf(t.walk.sp, wi);
    if (is_black(bsdf.f) || !(bsdf.pdf_forward > 0.0f)) return t.fail(ShiftResult::dark);
    if (!passes(t, bsdf.pdf_forward, false)) return t.fail(ShiftResult::too_early);
    if (t.walk.path.bounce == 0) t.out.first = wi;
    return true;
  }

  /// ray_id() of the ray that a sampled direction has at the current vertex. All shifts of a path draw the same alpha.
  RELUME_HD static uint32_t scattered_ray_id(Task& t) {
    skip_light(t.walk, t.sampler);
    t.sampler.next_2d();
    return t.sampler.ray_id();
  }

  RELUME_HD void connect_to_light(Task& t) const {
    const PathWalk& w = t.walk;
    const SceneView& scene = context.scene;
    skip_light(w, t.sampler);
    const LightPoint point = t.stored.light_point();
    const LightSample light = light_at(scene.lights, point, w.sp.position);
    BsdfEval bsdf;
    t.out.result = ShiftResult::dark;
    if (!light.valid() || !leaves_towards(t, light.wi, bsdf)) return;
    const float pdf_light =
        context.selector.pmf(w.sp, point.light) * density_of(scene.lights, point.light, w.sp.position, light);
    if (!(pdf_light > 0.0f)) return void(t.fail(ShiftResult::dark));
    if (t.traced) {
      ++t.rays;
      if (occluded(scene, shadow_ray(w.sp, light), t.sampler.ray_id())) return void(t.fail(ShiftResult::occluded));
    }
    const float mis = connection_weight(light, pdf_light, bsdf.pdf_forward);
    const bool dispersed = w.path.dispersed || disperses(scene, w.sp, light.wi);
    t.complete(reflected_light(scene, w.sp, w.path.medium, light, bsdf) * mis, dispersed, pdf_light / light.pdf_w);
  }

  RELUME_HD void connect_to_infinity(Task& t) const {
    const PathWalk& w = t.walk;
    const SceneView& scene = context.scene;
    const Vec3& wi = t.stored.leaving;
    BsdfEval bsdf;
    if (!leaves_towards(t, wi, bsdf)) return;
    const SegmentEnd from = segment_end(w.sp, wi, bsdf.pdf_forward, false, w.path.bounce);
    if (!rule.connects_to_end(from, 1.0f, kInfinity, w.footprint)) return void(t.fail(ShiftResult::no_joint));
    if (t.traced) {
      ++t.rays;
      if (occluded(scene, shadow_ray(w.sp, wi, kInfinity), scattered_ray_id(t)))
        return void(t.fail(ShiftResult::occluded));
    }
    const Rgb light = light_from_infinity(context, w.sp, wi, bsdf.pdf_forward, false);
    const bool dispersed = w.path.dispersed || disperses(scene, w.sp, wi);
    t.complete(bsdf.f * shading_cosine(w.sp, wi) * light, dispersed, bsdf.pdf_forward);
  }

  /// The segment from the last replayed vertex to a kept surface point.
  struct Segment {
    Vec3 wi{0};
    float distance = 0;  ///< metres
    float cosine = 0;    ///< |cos| at the kept point
    BsdfEval bsdf;       ///< of the vertex before
    SegmentEnd from;
    Ray ray;        ///< for occlusion
    Rgb value{0};   ///< f · cos · geometry, times the transmittance
    Rgb medium{0};  ///< absorption along it
    bool dispersed = false;

    RELUME_HD float geometry() const { return cosine / sqr(distance); }
  };

  /// Moves the walk along the segment to the kept surface point, without testing occlusion.
  RELUME_HD bool cross(Task& t, Segment& s) const {
    PathWalk& w = t.walk;
    const SceneView& scene = context.scene;
    const Hit hit = t.stored.hit();
    const SurfacePlace place = surface_place(scene, scene.instances[hit.instance], hit);
    const Vec3 d = place.position - w.sp.position;
    s.distance = glm::length(d);
    if (!(s.distance > 0.0f)) return t.fail(ShiftResult::dark);
    s.wi = d / s.distance;
    s.cosine = std::fabs(glm::dot(s.wi, place.front));
    if (!(s.cosine > 0.0f)) return t.fail(ShiftResult::dark);
    if (!leaves_towards(t, s.wi, s.bsdf)) return false;
    s.from = segment_end(w.sp, s.wi, s.bsdf.pdf_forward, false, w.path.bounce);
    s.value = s.bsdf.f * (shading_cosine(w.sp, s.wi) * s.geometry());
    s.dispersed = w.path.dispersed || disperses(scene, w.sp, s.wi);
    s.ray = shadow_ray(w.sp, s.wi, s.distance);
    const float clearance = 2.0f * place.error / relume::max(s.cosine, 1e-3f);
    s.ray.t_max = relume::min(s.ray.t_max, relume::max(s.distance - clearance, 0.0f));
    s.medium = medium_along(scene, w.sp, s.wi, w.path.medium);
    widen_cone(s.from, w);
    const Ray to_kept{w.sp.position, s.wi, kInfinity};
    make_surface_point(scene, to_kept, hit, w.cone_at(s.distance), w.sp, w.path.wavelength_nm);
    s.value *= transmittance_to(scene, w.sp, s.distance, s.medium);
    return true;
  }

  /// `ray_id`: as of scattered_ray_id() before cross().
  RELUME_HD bool is_blocked(Task& t, const Segment& s, uint32_t ray_id) const {
    if (!t.traced) return false;
    ++t.rays;
    return occluded(context.scene, s.ray, ray_id);
  }

  RELUME_HD void connect_to_emitter(Task& t) const {
    const PathWalk& w = t.walk;
    const uint32_t ray_id = scattered_ray_id(t);
    const float pmf = pmf_of_hit(context, w.sp, t.stored.hit());
    const Vec3 previous = w.sp.position;
    Segment s;
    if (!cross(t, s)) return;
    if (!rule.connects_to_end(s.from, s.cosine, s.distance, w.footprint)) return void(t.fail(ShiftResult::no_joint));
    const Rgb light = emitted(t, previous, pmf, s.bsdf.pdf_forward, false);
    if (is_black(light)) return void(t.fail(ShiftResult::dark));
    if (is_blocked(t, s, ray_id)) return void(t.fail(ShiftResult::occluded));
    t.complete(s.value * light, s.dispersed, s.bsdf.pdf_forward * s.geometry());
  }

  RELUME_HD void connect_to_vertex(Task& t) const {
    const PathWalk& w = t.walk;
    const SceneView& scene = context.scene;
    const StoredPath& stored = t.stored;
    const uint32_t ray_id = scattered_ray_id(t);
    Segment s;
    if (!cross(t, s)) return;
    s.dispersed = s.dispersed || disperses(scene, w.sp, w.sp.ng);
    const bool is_last = stored.joint() + 1 == stored.length();
    LightSample light;
    const bool connects = is_last && stored.end() == PathEnd::connection;
    if (connects) light = light_at(scene.lights, stored.light_point(), w.sp.position);
    if (connects && !light.valid()) return void(t.fail(ShiftResult::dark));
    const Vec3 leaving = connects ? light.wi : stored.leaving;
    const BsdfEval bsdf = w.sp.bsdf.empty() ? BsdfEval{} : eval_pdf(w.sp, leaving);
    if (is_black(bsdf.f) || !(bsdf.pdf_forward > 0.0f)) return void(t.fail(ShiftResult::dark));
    const SegmentEnd to{bsdf.pdf_forward, narrowest_alpha(w.sp.bsdf), s.cosine, false};
    if (!rule.connects(s.from, to, s.distance, w.footprint)) return void(t.fail(ShiftResult::no_joint));
    if (!same_medium(medium_along(scene, w.sp, leaving, s.medium), stored.medium))
      return void(t.fail(ShiftResult::other_media));
    const bool dispersed = s.dispersed || disperses(scene, w.sp, leaving);
    const bool is_cached = stored.end() == PathEnd::cached;
    if (is_cached != ends_cached(stored, dispersed)) return void(t.fail(ShiftResult::other_end));
    float density = s.bsdf.pdf_forward * s.geometry();
    const Rgb end = connects ? connected(t, s, light, bsdf, density) : arriving(t, leaving, bsdf, density);
    if (is_black(end)) return void(t.fail(ShiftResult::dark));
    if (is_blocked(t, s, ray_id)) return void(t.fail(ShiftResult::occluded));
    if (is_cached) return t.complete_cached(s.value * end, density);
    t.complete(s.value * end, dispersed || stored.suffix_disperses(), density);
  }

  /// Whether a candidate with the shifted path up to the joint has a cached end, if light is found behind the vertex
  /// after it. `dispersed`: whether a vertex up to the joint scatters by wavelength.
  RELUME_HD bool ends_cached(const StoredPath& stored, bool dispersed) const {
    return uses_cells && !dispersed && stored.joint() + 1 < stored.length();
  }

  /// Light that the joint reflects from the connected light. Multiplies `density` by that of the light's coordinates.
  RELUME_HD Rgb connected(const Task& t, const Segment& s, const LightSample& light, const BsdfEval& bsdf,
                          float& density) const {
    const SurfacePoint& sp = t.walk.sp;
    const LightsView& lights = context.scene.lights;
    const LightId id = t.stored.light;
    const float pdf_light = context.selector.pmf(sp, id) * density_of(lights, id, sp.position, light);
    if (!(pdf_light > 0.0f)) return Rgb(0);
    density *= pdf_light / light.pdf_w;
    const float mis = connection_weight(light, pdf_light, bsdf.pdf_forward);
    return reflected_light(context.scene, sp, s.medium, light, bsdf) * mis;
  }

  /// Light that the joint reflects from the stored direction; without the light of a cached end. Multiplies `density`
  /// by that of the direction.
  RELUME_HD Rgb arriving(const Task& t, const Vec3& leaving, const BsdfEval& bsdf, float& density) const {
    const SurfacePoint& sp = t.walk.sp;
    const StoredPath& stored = t.stored;
    density *= bsdf.pdf_forward;
    const Rgb factor = bsdf.f * shading_cosine(sp, leaving);
    if (stored.end() == PathEnd::cached) return factor;
    if (stored.joint() + 1 < stored.length()) return factor * stored.suffix;
    if (stored.end() == PathEnd::infinity)
      return factor * light_from_infinity(context, sp, leaving, bsdf.pdf_forward, false);
    if (stored.light == kNoLight) return factor * stored.suffix;
    const float pmf = context.selector.pmf(sp, stored.light);
    return factor * stored.suffix * scatter_weight(bsdf.pdf_forward, pmf, stored.light_pdf_w);
  }

  /// Whether the media behind the joint are those of the stored path, up to rounding of their sums.
  RELUME_HD static bool same_medium(const Rgb& a, const Rgb& b) {
    const Rgb difference = abs(a - b);
    return max_component(difference) <= 1e-4f * (max_component(a) + max_component(b));
  }
};

}  // namespace relume
