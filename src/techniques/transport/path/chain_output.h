// Output of new states for the Markov chains of path guiding and light selection.
#pragma once

#include "techniques/guiding/markov_chain/cached_guide_recorder.h"
#include "techniques/light_sampling/markov_chain_lights/light_chain_recorder.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Records the first vertices of a path, for either kind of chains or for both. Directions or lights without chains
/// record no vertices.
template <typename Guide>
struct ChainPolicyWith : NoPolicy {
  Guide guide;
  LightChainRecorder lights;

  RELUME_HD void hit_surface(const SurfacePoint& sp, const PathState& path) { guide.hit_surface(sp, path); }
  RELUME_HD void emitted(const PathState& path, bool covered_by_nee) { guide.emitted(path, covered_by_nee); }
  RELUME_HD void light_picked(const SurfacePoint& sp, const PathState& path, LightId light) {
    lights.light_picked(sp, path, light);
  }
  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& c, bool visible) {
    lights.connected(sp, path, c, visible);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const PathState& after) {
    guide.scattered(sp, s, after);
  }
  RELUME_HD void finished(const PathState& path) {
    guide.finished(path);
    lights.finished(path);
  }
  RELUME_HD void rebased(const Rgb& found, const Rgb& unit) { guide.rebased(found, unit); }
};

using ChainPolicy = ChainPolicyWith<GuideRecorder>;

/// Records the first vertices of a path of which a cache replaces parts: the light of a cell is part of the score of
/// directions. Scores of lights are those of single vertices, which no cell changes.
struct CachedChainPolicy : ChainPolicyWith<CachedGuideRecorder> {
  RELUME_HD void ended_in_cell(const Rgb& radiance) { guide.ended_in_cell(radiance); }
};

/// Output of the states of each path.
struct ChainOutput {
  using Policy = ChainPolicy;

  GuideRecording guide;
  LightChainRecording lights;

  RELUME_HD ChainPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    return policy_of<ChainPolicy>(pixel);
  }
  RELUME_HD void finish(uint32_t, const ChainPolicy&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const {
    guide.out.skip(pixel);
    lights.out.skip(pixel);
  }

  /// The policy of a pixel, of either type.
  template <typename Recorders>
  RELUME_HD Recorders policy_of(uint32_t pixel) const {
    Recorders policy;
    policy.guide.recording = &guide;
    policy.guide.pixel = pixel;
    policy.lights.recording = &lights;
    policy.lights.pixel = pixel;
    return policy;
  }
};

/// Output of the states of each path of which a later output, that of a cache, replaces parts.
struct CachedChainOutput {
  using Policy = CachedChainPolicy;

  ChainOutput chains;

  RELUME_HD CachedChainPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    return chains.policy_of<CachedChainPolicy>(pixel);
  }
  RELUME_HD void finish(uint32_t, const CachedChainPolicy&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const { chains.leave_out(pixel); }
};

}  // namespace relume
