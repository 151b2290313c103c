// Choices along the path of a candidate: lights and directions. Shifts repeat random numbers without what was learned
// when the path was traced, so all that they evaluate again comes from choices that do not learn (README.md).
#pragma once

#include <type_traits>

#include "techniques/reuse/restir_pt/path_walk.h"
#include "techniques/transport/path/chain_output.h"
#include "techniques/transport/path/recording_output.h"

namespace relume {

/// The choices along one path, by a context that shifts have, too. They do not learn. LearnedPath has the same members.
/// `past_joint`: whether the path has left its joint, so that shifts keep all that follows.
struct FixedPath {
  /// Called at a vertex before its choices.
  RELUME_HD void arrived(PathWalk&) {}
  /// Starts a vertex, and selects the light of next event estimation there, if any.
  RELUME_HD LightPick pick(const PathContext& c, const PathWalk& w, bool /*past_joint*/, Sampler& sampler) {
    return pick_light_at(c, w.sp, w.path, sampler);
  }
  /// MIS weight of the last picked light.
  RELUME_HD float light_weight(const PathContext&, const PathWalk&, bool /*past_joint*/, const LightPick& pick,
                               const LightSample& light, const BsdfEval& bsdf) const {
    return connection_weight(light, pick.pmf * light.pdf_w, bsdf.pdf_forward);
  }
  /// Samples the direction that leaves a vertex. Before the joint, weight and density are those of the BSDF.
  RELUME_HD BsdfSample sample(const PathContext& c, const ConnectRule&, const PathWalk& w, bool /*past_joint*/,
                              Sampler& sampler) {
    return c.directions.sample(w.sp, sampler);
  }
  /// Called where the path has left a vertex that is not past the joint. `is_joint`: the vertex is the joint. Returns
  /// false if the path ends: shifts would have to repeat a direction that they cannot sample.
  RELUME_HD bool settle(bool /*is_joint*/) { return true; }
  /// Called after that, if Russian roulette continues the path. `s`: the result of sample(). `scale`, here and below:
  /// one over the probability with which the path has survived.
  RELUME_HD void scattered(PathWalk&, const BsdfSample& /*s*/, bool /*past_joint*/, float /*scale*/) {}
  /// Factor of the weight of a path to light that continues this one. `connects()`: whether the last two vertices, or
  /// the last vertex and the light, are a joint and the vertex before it.
  template <typename Connects>
  RELUME_HD float weight(const Connects&) const {
    return 1.0f;
  }
  /// Probability of selecting the light of a surface that the path hits from its current vertex. `stored`, here and
  /// below: whether that vertex is past the joint, so that shifts keep the MIS weight.
  RELUME_HD float pmf_of_hit(const PathContext& c, const PathWalk& w, const Hit& hit, bool /*stored*/) const {
    return relume::pmf_of_hit(c, w.sp, hit);
  }
  /// Light from infinity along the path's ray, with MIS weights.
  RELUME_HD Rgb light_from_infinity(const PathContext& c, PathWalk& w, bool /*stored*/) {
    return relume::light_from_infinity(c, w.sp, w.path.ray.direction, w.path.pdf_w, w.path.delta);
  }
  // For learning; as the hooks of path policies (techniques/transport/path/path_policy.h).
  RELUME_HD void light_picked(const PathWalk&, LightId) {}
  /// `value`: light in the image, without the factors `scale` and weight().
  RELUME_HD void connected(PathWalk&, LightId, const Rgb& /*value*/, float /*scale*/, bool /*visible*/) {}
  RELUME_HD void hit_surface(const PathWalk&) {}
  /// Adds light to the radiance that the path has found in the image.
  RELUME_HD void add(PathWalk&, const Rgb& /*light*/) {}
  RELUME_HD void met_emitter(const PathWalk&) {}
  RELUME_HD void met_infinity(const PathWalk&) {}
  RELUME_HD void finished(const PathWalk&) {}
  /// Called at the vertex after the joint, if the policy `cache` finds the light that it reflects. Returns the policies
  /// of the rest of the path.
  template <typename Cache>
  RELUME_HD PathPolicies<Cache&> enter_cells(const PathWalk&, float /*scale*/, Cache& cache) {
    return {cache, {}};
  }
};

/// Choices that do not learn, for all pixels. LearnedChoices has the same members.
struct FixedChoices {
  /// `kEndsInCells`, here and below: whether a cache may find the light behind joints.
  template <bool kEndsInCells>
  using Path = FixedPath;

  template <bool kEndsInCells>
  RELUME_HD FixedPath begin(uint32_t) const {
    return {};
  }
  /// Called for pixels without a path.
  RELUME_HD void leave_out(uint32_t) const {}
};

/// Share of lights that fixed selection picks up to the joint. MIS weights there are those of fixed selection. This
/// share bounds the weight of a picked light by 1 / share, and makes all lights possible that it can select.
inline constexpr float kFixedLightShare = 0.25f;

/// Least probability of the BSDF up to the joint, and with Markov chains everywhere. Directions that shifts repeat are
/// samples of the BSDF.
inline constexpr float kLeastBsdfShare = 0.5f;

template <bool kEndsInCells>
struct LearnedPath;

/// Choices that learn are those of the path context. Here are the destinations of what their paths find.
struct LearnedChoices {
  template <bool kEndsInCells>
  using Path = LearnedPath<kEndsInCells>;

  PathRecording samples;       ///< used if `records_samples`
  ChainOutput chains;          ///< parts without a destination record nothing
  bool learns_lights = false;  ///< whether light selection learns; the fixed one is then the selector's light tree
  bool records_samples = false;

  template <bool kEndsInCells>
  RELUME_HD LearnedPath<kEndsInCells> begin(uint32_t pixel) const;
  RELUME_HD void leave_out(uint32_t pixel) const {
    if (records_samples) samples.skip(pixel);
    chains.leave_out(pixel);
  }
};

/// Records the vertices of a path that may end in cells behind its joint.
struct SuffixRecorder : CachedPathRecorder {
  float weight_at_joint = 1;  ///< weight of the records there, a factor of that of later ones

  RELUME_HD void survived(float probability) { CachedPathRecorder::survived(probability / weight_at_joint); }
};

/// The choices along one path, by what was learned. As FixedPath. The walk keeps the values of the BSDF alone up to the
/// joint, whatever sampled a direction. The density that was used only enters weight(). A direction that shifts keep
/// has the factor p_BSDF / p. One that they repeat must be a sample of the BSDF: the factor is one over the probability
/// of asking it, or 0. Which of both holds is known at the next vertex.
template <bool kEndsInCells>
struct LearnedPath {
  using Samples = std::conditional_t<kEndsInCells, SuffixRecorder, PathRecorder>;
  using Chains = std::conditional_t<kEndsInCells, CachedChainPolicy, ChainPolicy>;

  const LearnedChoices* choices;
  Samples samples;
  Chains chains;
  float settled = 1;    ///< product of the factors that are known
  float kept = 1;       ///< factor of the last direction, if shifts keep it
  float repeated = 1;   ///< factor of the last direction, if shifts repeat it
  float next_kept = 1;  ///< the same, here and below, of the direction that leaves the current vertex
  float next_repeated = 1;
  float record_weight = 1;  ///< of recorded samples from the current vertex on
  float fixed_pmf = 0;      ///< probability with which fixed selection picks the last picked light
  bool selectable = false;  ///< whether next event estimation can select light from infinity that the path has met
  bool in_cells = false;    ///< whether the policies of enter_cells() complete the records

  RELUME_HD void arrived(PathWalk& w) {
    if (!choices->records_samples) return;
    samples.arrived(w.sp, w.path);
    weigh_record();
  }

  RELUME_HD LightPick pick(const PathContext& c, const PathWalk& w, bool past_joint, Sampler& sampler) {
    if (!start_vertex(c, w.sp, w.path, sampler)) return {};
    const Vec2 u = sampler.next_2d();
    ReusableNumber n = sampler.reusable(u.x);
    const LightSelection s = past_joint ? c.selector.sample(w.sp, n) : pick_up_to_joint(c, w.sp, n);
    return {s.light, s.pmf, {s.u, u.y}};
  }

  RELUME_HD float light_weight(const PathContext& c, const PathWalk& w, bool past_joint, const LightPick& pick,
                               const LightSample& light, const BsdfEval& bsdf) const {
    if (!past_joint && !(fixed_pmf > 0.0f)) return 0.0f;  // as in shifts
    if (light.delta) return 1.0f;
    return past_joint ? power_heuristic(pick.pmf * light.pdf_w, c.directions.pdf(w.sp, light.wi, bsdf))
                      : power_heuristic(fixed_pmf * light.pdf_w, bsdf.pdf_forward);
  }

  RELUME_HD BsdfSample sample(const PathContext& c, const ConnectRule& rule, const PathWalk& w, bool past_joint,
                              Sampler& sampler) {
    next_kept = next_repeated = 1;
    if (past_joint) return c.directions.sample(w.sp, sampler);
    const PathState& path = w.path;
    const bool guides = rule.may_keep_direction(narrowest_alpha(w.sp.bsdf), path.bounce, path.delta);
    // A dimension of this bounce from which no other choice takes a single number.
    const float u = sampler.number_of(kCameraDimensions + path.bounce * kDimensionsPerBounce + 1);
    const SeparateDirection d = c.directions.sample_separately(w.sp, guides ? kLeastBsdfShare : 1.0f, u, sampler);
    next_kept = d.ratio;
    next_repeated = d.guided ? 0.0f : 1.0f / d.fraction;
    return d.bsdf;
  }

  RELUME_HD bool settle(bool is_joint) {
    if (!is_joint && repeated > 0.0f) {
      record_weight *= repeated / kept;  // one over the probability of the BSDF, given the direction
      weigh_record();
    }
    settled *= is_joint ? kept * next_kept : repeated;
    kept = is_joint ? 1.0f : next_kept;
    repeated = is_joint ? 1.0f : next_repeated;
    return settled > 0.0f;
  }

  /// Not inlined, here and below, to bound the stack of kernels.
  RELUME_HD_NOINLINE void scattered(PathWalk& w, BsdfSample s, bool past_joint, float scale) {
    const float pdf_w = w.path.pdf_w;
    if (!past_joint) {
      s.weight *= next_kept;
      s.pdf_w /= next_kept;
    }
    w.path.pdf_w = s.pdf_w;
    in_image(w, scale, [&](const PathState& path) {
      if (choices->records_samples) samples.scattered(w.sp, s, path);
      chains.scattered(w.sp, s, path);
    });
    w.path.pdf_w = pdf_w;
  }

  template <typename Connects>
  RELUME_HD float weight(const Connects& connects) const {
    return kept == repeated ? settled * kept : settled * (connects() ? kept : repeated);
  }

  RELUME_HD float pmf_of_hit(const PathContext& c, const PathWalk& w, const Hit& hit, bool stored) const {
    const Instance& instance = c.scene.instances[hit.instance];
    return instance.first_light != kNoLight ? pmf(c, w.sp, light_of(instance, hit.primitive), stored) : 0.0f;
  }

  RELUME_HD Rgb light_from_infinity(const PathContext& c, PathWalk& w, bool stored) {
    const PathState& path = w.path;
    const auto light_pmf = [&](LightId id) {
      const float of_light = pmf(c, w.sp, id, stored);
      selectable = selectable || of_light > 0.0f;
      return of_light;
    };
    return relume::light_from_infinity(c.scene.lights, w.sp.position, path.ray.direction, path.pdf_w, path.delta,
                                       light_pmf);
  }

  RELUME_HD void light_picked(const PathWalk& w, LightId light) { chains.light_picked(w.sp, w.path, light); }

  RELUME_HD_NOINLINE void connected(PathWalk& w, LightId light, const Rgb& value, float scale, bool visible) {
    const PickedLight picked{value * (scale * settled * kept), light};
    in_image(w, scale, [&](const PathState& path) {
      if (choices->records_samples) samples.connected(w.sp, path, picked, visible);
      chains.lights.connected(w.sp, path, picked, visible);
    });
  }

  RELUME_HD void hit_surface(const PathWalk& w) { chains.hit_surface(w.sp, w.path); }
  RELUME_HD void add(PathWalk& w, const Rgb& light) { w.path.radiance += light; }
  RELUME_HD void met_emitter(const PathWalk& w) {
    emitted(w, !w.path.delta && w.sp.light != kNoLight && !is_black(w.sp.emission));
  }
  RELUME_HD void met_infinity(const PathWalk& w) { emitted(w, selectable); }
  RELUME_HD void finished(const PathWalk& w) {
    if (in_cells) return;
    if (choices->records_samples) samples.finished(w.path);
    chains.finished(w.path);
  }

  /// The recorders count the rest of the path by its factor in the image, and learn what the cache does. Without a
  /// destination of samples, they record no vertices.
  template <typename Cache>
  RELUME_HD PathPolicies<Samples&, Chains&, Cache&> enter_cells(const PathWalk& w, float scale, Cache& cache) {
    const Rgb unit = w.path.throughput * (scale * settled);
    samples.weight_at_joint = record_weight;
    samples.survived(1.0f);
    samples.rebased(w.path.radiance, unit);
    chains.rebased(w.path.radiance, unit);
    cache.rebased(w.path.radiance, unit);
    in_cells = true;
    return {samples, {chains, {cache, {}}}};
  }

 private:
  /// The members of a connection that recorders read.
  struct PickedLight {
    Rgb contribution;
    LightId light;
  };

  /// Probability of selecting a light, `stored`: by what was learned, else by fixed selection.
  RELUME_HD float pmf(const PathContext& c, const SurfacePoint& sp, LightId light, bool stored) const {
    return stored || !choices->learns_lights ? c.selector.pmf(sp, light) : c.selector.tree.pmf(sp, light);
  }

  /// Selects a light by a mixture of both selections.
  RELUME_HD LightSelection pick_up_to_joint(const PathContext& c, const SurfacePoint& sp, ReusableNumber n) {
    const LightSelector& selector = c.selector;
    const bool learns = choices->learns_lights;
    const bool is_fixed = learns && takes_share(kFixedLightShare, n);
    LightSelection s = is_fixed ? selector.tree.sample(sp, n) : selector.sample(sp, n);
    fixed_pmf = s.pmf;
    if (!learns || !(s.pmf > 0.0f)) return s;
    float learned_pmf = s.pmf;
    if (is_fixed) {
      learned_pmf = selector.pmf(sp, s.light);
    } else {
      fixed_pmf = selector.tree.pmf(sp, s.light);
    }
    s.pmf = kFixedLightShare * fixed_pmf + (1.0f - kFixedLightShare) * learned_pmf;
    return s;
  }

  RELUME_HD void weigh_record() const {
    const PathRecording& recording = choices->samples;
    if (choices->records_samples && samples.current < recording.vertices)
      recording.sample(samples.current, samples.pixel).weight = record_weight;
  }

  RELUME_HD void emitted(const PathWalk& w, bool covered_by_nee) {
    if (choices->records_samples) samples.emitted(w.path, covered_by_nee);
    chains.emitted(w.path, covered_by_nee);
  }

  /// Calls `hook` with the throughput of the path in the image.
  template <typename Hook>
  RELUME_HD void in_image(PathWalk& w, float scale, const Hook& hook) const {
    const Rgb throughput = w.path.throughput;
    w.path.throughput *= w.dispersion() * (scale * settled * kept);
    hook(w.path);
    w.path.throughput = throughput;
  }
};

template <bool kEndsInCells>
RELUME_HD inline LearnedPath<kEndsInCells> LearnedChoices::begin(uint32_t pixel) const {
  LearnedPath<kEndsInCells> path;
  path.choices = this;
  path.samples.recording = &samples;
  path.samples.pixel = pixel;
  path.chains = chains.policy_of<typename LearnedPath<kEndsInCells>::Chains>(pixel);
  return path;
}

}  // namespace relume
