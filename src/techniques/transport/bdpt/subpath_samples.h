// Samples of indirect light from bidirectional paths, for reservoirs (techniques/reuse).
//
// A path has the vertices x0 on the camera, x1 at the primary hit, x2, … and one on a light. A sample is x2 and the
// light that its lobes with a density scatter to x1. Any other pixel may connect to x2, with densities of its own.
// Weights of the sample must therefore not depend on how x1 and x2 were found. They count the strategies whose camera
// subpath has at least the three vertices x0, x1, x2: for given x1 and x2, they sample all light that arrives at x2,
// and their weights sum to one. The recursion of partial weights thus restarts at x2 with A = B = 0. The strategies
// with fewer camera vertices would find the same light again, so they leave it out: connections between x1 and light
// subpaths, mergings at x1, and splats.
//
// Light that x2 scatters by a delta lobe, such as a caustic on x1, stays with all strategies and their weights. Its
// samples could not move to other pixels, and splats are the best way to find it. How x2 scatters is a property of the
// path, and all strategies recognise it.
#pragma once

#include "techniques/transport/bdpt/partial_weights.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {

/// Records the sample of a camera subpath, and removes its light. Connections and mergings at x2 belong to the sample.
/// So does the rest of the subpath, unless it leaves x2 by a delta lobe.
struct SubpathSamplePolicy : IndirectSamplePolicy {
  static constexpr bool samples_indirect_light = true;

  SubpathWeights image_weights;  ///< at x2, of the light that stays with the subpath
  Rgb before{0};                 ///< radiance of the subpath before its first direction
  Rgb found{0};                  ///< light of the sample, if it is complete
  float eta_scale = 1;           ///< of the subpath that arrives at x2
  float rr_reference = 1;        ///< the same
  bool complete = false;         ///< whether the subpath has left x2 by a delta lobe

  RELUME_HD void hit_surface(const SurfacePoint& sp, const PathState& path) {
    IndirectSamplePolicy::hit_surface(sp, path);
    if (path.bounce != 1) return;
    eta_scale = path.eta_scale;
    rr_reference = path.rr_reference;
  }
  template <typename Earlier>
  RELUME_HD bool arrived(const SurfacePoint& sp, PathState& path, Earlier& earlier) {
    if (path.bounce == 1 && !has_non_delta(sp.bsdf)) candidate = false;
    return IndirectSamplePolicy::arrived(sp, path, earlier);
  }
  /// Called after arrived(), with the weights of the subpath there.
  RELUME_HD void weigh_vertex(const PathState& path, SubpathWeights& weights) {
    if (!taken || path.bounce != 1) return;
    image_weights = weights;
    weights.restart();
  }
  /// Called for each connection and merging at the last vertex, before roulette and the test of visibility. Each pixel
  /// has its own wavelength, so samples that depend on it must not move. Whether a sample is bound must depend on its
  /// vertex alone, not on the pixel: otherwise the samples that move would have a bias.
  RELUME_HD void tried(const Connection& c) {
    if (taken && !complete && c.dispersed) sample->vertex.traits |= IndirectVertex::kBound;
  }
  /// Called before scattered(), and before the weights leave the vertex.
  RELUME_HD void weigh_onwards(const PathState& after, SubpathWeights& weights) const {
    if (leaves_sample(after)) weights = image_weights;
  }
  template <typename Earlier>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& after, Earlier& earlier) {
    IndirectSamplePolicy::scattered(sp, s, after);
    if (after.bounce == 1) before = after.radiance;
    if (!leaves_sample(after)) return;
    complete = true;
    found = after.radiance;
    after.radiance = Rgb(0);
    after.throughput *= unit;
    after.eta_scale *= eta_scale;
    after.rr_reference = rr_reference;
    earlier.rebased(found, base);
  }
  RELUME_HD void finished(PathState& path) {
    const Rgb rest = complete ? path.radiance : Rgb(0);
    if (complete) path.radiance = found;
    IndirectSamplePolicy::finished(path);
    path.radiance += rest;
  }
  /// Radiance in the image that the finished subpath has found along its first direction. `with_sample`: the same with
  /// the light of its sample, if it has one.
  RELUME_HD Rgb found_beside_sample(const PathState& path, const Rgb& with_sample) const {
    return taken ? base * (path.radiance - before) : with_sample;
  }

 private:
  RELUME_HD bool leaves_sample(const PathState& after) const { return taken && after.bounce == 2 && after.delta; }
};

/// The policy of a camera subpath whose sample `output` stores. The other arguments are those of
/// IndirectSampleOutput::policy().
RELUME_HD inline SubpathSamplePolicy subpath_sample_policy(const IndirectSampleOutput& output, const SampleIndex& index,
                                                           uint32_t x, uint32_t y, uint32_t pixel) {
  SubpathSamplePolicy policy;
  static_cast<IndirectSamplePolicy&>(policy) = output.policy(index, x, y, pixel);
  return policy;
}

/// Output of camera subpaths whose indirect light reservoirs add, as SubpathRadiance. The context must have
/// PathContext::indirect_to_reservoirs.
struct SubpathSamples {
  View<Rgb> radiance;  ///< of this sample, without splats; may be not finite
  IndirectSampleOutput samples;

  RELUME_HD SubpathSamplePolicy policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    return subpath_sample_policy(samples, index, x, y, pixel);
  }
  RELUME_HD void finish(uint32_t pixel, const SubpathSamplePolicy&, const Rgb& seen) const { radiance[pixel] = seen; }
  RELUME_HD void leave_out(uint32_t pixel) const {
    radiance[pixel] = Rgb(0);
    samples.leave_out(pixel);
  }
};

}  // namespace relume
