// Output of new states for the Markov chains of path guiding and light selection.
#pragma once

#include "techniques/guiding/markov_chain/guide_recorder.h"
#include "techniques/light_sampling/markov_chain_lights/light_chain_recorder.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Records the first vertices of a path, for either kind of chains or for both. Directions or lights without chains
/// record no vertices.
struct ChainPolicy : NoPolicy {
  GuideRecorder guide;
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

/// Output of the states of each path.
struct ChainOutput {
  using Policy = ChainPolicy;

  GuideRecording guide;
  LightChainRecording lights;

  RELUME_HD ChainPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    ChainPolicy policy;
    policy.guide.recording = &guide;
    policy.guide.pixel = pixel;
    policy.lights.recording = &lights;
    policy.lights.pixel = pixel;
    return policy;
  }
  RELUME_HD void finish(uint32_t, const ChainPolicy&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const {
    guide.out.skip(pixel);
    lights.out.skip(pixel);
  }
};

}  // namespace relume
