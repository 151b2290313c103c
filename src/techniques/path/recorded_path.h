// Paths that leave samples for what learns in the regions of the octree.
#pragma once

#include "techniques/octree/path_recording.h"
#include "techniques/path/first_vertex.h"

namespace relume {

/// PathKernel that also leaves records of the first vertices for learning and, if wanted, for histories.
struct RecordedPathKernel {
  PathContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths the pixel gets, 0 or 1; empty: 1
  View<Rgb> radiance;               ///< of this sample; may be not finite
  View<uint32_t> rays;              ///< of this sample
  PathRecording recording;
  View<FirstVertex> first_vertices;  ///< empty: not wanted
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const { trace_pixel(*this, x, y); }
  void operator()(const Tile& tile) const { path_batch::trace_tile(*this, tile); }

  RELUME_HD bool wanted(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }
  RELUME_HD void leave_out(uint32_t pixel) const {
    radiance[pixel] = Rgb(0);
    rays[pixel] = 0;
    recording.skip(pixel);
    if (!first_vertices.empty()) first_vertices[pixel] = {};
  }
  RELUME_HD BothObservers<PathRecorder, FirstVertexObserver> observer(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    FirstVertexObserver first{first_vertices.empty() ? nullptr : &first_vertices[pixel]};
    if (first.vertex) *first.vertex = {};
    return {recording.begin(pixel), first};
  }
  template <typename Observer>
  RELUME_HD void finish(uint32_t pixel, const Observer&, const PathState& path) const {
    radiance[pixel] = path.radiance;
    rays[pixel] = path.rays;
  }
};

}  // namespace relume
