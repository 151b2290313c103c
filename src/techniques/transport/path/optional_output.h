// An output that a kernel has or lacks at run time. Rare combinations of outputs share a kernel through it: each kernel
// is compiled for hosts and devices.
#pragma once

#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// An observing policy that may be switched off. It must take no events: these would reach it in any case.
template <typename Observer>
struct OptionalPolicy : Observer {
  bool active = false;

  RELUME_HD void hit_surface(const SurfacePoint& sp, const PathState& path) {
    if (active) Observer::hit_surface(sp, path);
  }
  RELUME_HD void emitted(const PathState& path, bool covered_by_nee) {
    if (active) Observer::emitted(path, covered_by_nee);
  }
  RELUME_HD bool arrived(const SurfacePoint& sp, const PathState& path) {
    return !active || Observer::arrived(sp, path);
  }
  RELUME_HD void light_picked(const SurfacePoint& sp, const PathState& path, LightId light) {
    if (active) Observer::light_picked(sp, path, light);
  }
  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& c, bool visible) {
    if (active) Observer::connected(sp, path, c, visible);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const PathState& after) {
    if (active) Observer::scattered(sp, s, after);
  }
  RELUME_HD void finished(const PathState& path) {
    if (active) Observer::finished(path);
  }
};

template <typename Contained>
struct OptionalOutput {
  using Policy = OptionalPolicy<typename Contained::Policy>;

  Contained output;
  bool active = false;  ///< whether `output` is valid

  RELUME_HD Policy policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    if (!active) return {};
    return {output.policy(index, x, y, pixel), true};
  }
  RELUME_HD void finish(uint32_t pixel, const Policy& policy, const PathState& path) const {
    if (active) output.finish(pixel, policy, path);
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    if (active) output.leave_out(pixel);
  }
};

}  // namespace relume
