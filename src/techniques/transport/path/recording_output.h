// Output of samples for learning into the regions of the octree.
#pragma once

#include "techniques/spatial/octree/cached_path_recorder.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Records the first vertices of each path.
struct RecordingOutput {
  using Policy = PathRecorder;

  PathRecording recording;

  RELUME_HD PathRecorder policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    return recording.begin(pixel);
  }
  RELUME_HD void finish(uint32_t, const PathRecorder&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const { recording.skip(pixel); }
};

/// Records the first vertices of each path of which a later output, that of a cache, replaces parts.
struct CachedRecordingOutput {
  using Policy = CachedPathRecorder;

  PathRecording recording;

  RELUME_HD CachedPathRecorder policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    CachedPathRecorder recorder;
    recorder.recording = &recording;
    recorder.pixel = pixel;
    return recorder;
  }
  RELUME_HD void finish(uint32_t, const CachedPathRecorder&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const { recording.skip(pixel); }
};

}  // namespace relume
