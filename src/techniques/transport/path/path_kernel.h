// The pass kernel of everything that traces one path a pixel.
#pragma once

#include "techniques/transport/path/path_batch.h"

namespace relume {

/// Traces one path a pixel from the primary hits. `Observation` says what watches the paths, and keeps what comes out:
///   observer(index, x, y, pixel)    watches the pixel's path, as NoObserver explains
///   finish(pixel, observer, path)   the path is complete
///   leave_out(pixel)                the pixel gets none
template <typename Observation>
struct ObservedPathKernel {
  PathContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths the pixel gets, 0 or 1; empty: 1
  View<uint32_t> rays;              ///< of this sample
  uint32_t width = 0;
  Observation observation;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (!wanted(pixel)) return leave_out(pixel);
    Sampler sampler = index.sampler(x, y);
    auto watcher = observation.observer(index, x, y, pixel);
    PathState path = trace_path(context, x, y, sampler, hits[pixel], watcher);
    finish(pixel, watcher, path);
  }

  /// Host: some paths of the tile side by side.
  void operator()(const Tile& tile) const { path_batch::trace_tile(*this, tile); }

  RELUME_HD bool wanted(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }
  RELUME_HD void leave_out(uint32_t pixel) const {
    observation.leave_out(pixel);
    rays[pixel] = 0;
  }
  RELUME_HD auto observer(uint32_t x, uint32_t y) const { return observation.observer(index, x, y, y * width + x); }
  template <typename Observer>
  RELUME_HD void finish(uint32_t pixel, Observer& watcher, PathState& path) const {
    observation.finish(pixel, watcher, path);
    rays[pixel] = path.rays;
  }
};

/// Keeps nothing but the radiance.
struct RadianceObservation {
  View<Rgb> radiance;  ///< of this sample; may be not finite

  RELUME_HD NoObserver observer(const SampleIndex&, uint32_t, uint32_t, uint32_t) const { return {}; }
  RELUME_HD void finish(uint32_t pixel, const NoObserver&, const PathState& path) const {
    radiance[pixel] = path.radiance;
  }
  RELUME_HD void leave_out(uint32_t pixel) const { radiance[pixel] = Rgb(0); }
};

using PathKernel = ObservedPathKernel<RadianceObservation>;

}  // namespace relume
