// Paths that leave samples for what learns in the regions of the octree.
#pragma once

#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {

/// Keeps radiance, records of the first vertices for learning and, if wanted, the very first for histories.
struct RecordingObservation {
  View<Rgb> radiance;  ///< of this sample; may be not finite
  PathRecording recording;
  View<FirstVertex> first_vertices;  ///< empty: not wanted

  RELUME_HD BothObservers<PathRecorder, FirstVertexObserver> observer(const SampleIndex&, uint32_t, uint32_t,
                                                                      uint32_t pixel) const {
    return {recording.begin(pixel), watch_first_vertex(first_vertices, pixel)};
  }
  template <typename Observer>
  RELUME_HD void finish(uint32_t pixel, const Observer&, const PathState& path) const {
    radiance[pixel] = path.radiance;
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    radiance[pixel] = Rgb(0);
    recording.skip(pixel);
    if (!first_vertices.empty()) first_vertices[pixel] = {};
  }
};

using RecordedPathKernel = ObservedPathKernel<RecordingObservation>;

}  // namespace relume
