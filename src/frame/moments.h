// Access to pixel moments from passes.
#pragma once

#include "frame/frame_context.h"

namespace relume {

/// Buffer ids for a pass declaration. Includes `m2_rgb`, which may not exist; declare the list as optional.
inline std::vector<BufferId> moment_ids(const MomentBuffers& buffers) {
  return {buffers.mean, buffers.m2, buffers.m2_rgb, buffers.samples};
}

inline MomentsView read_moments(const FrameContext& frame, const MomentBuffers& buffers) {
  return {frame.read(buffers.mean), frame.read(buffers.m2), frame.read(buffers.m2_rgb), frame.read(buffers.samples)};
}

inline MutableMomentsView write_moments(const FrameContext& frame, const MomentBuffers& buffers) {
  return {frame.write(buffers.mean), frame.write(buffers.m2), frame.write(buffers.m2_rgb),
          frame.write(buffers.samples)};
}

/// Moments of the earlier samples that this frame's pixels keep: reprojected ones, or those of the previous frame.
/// Valid until AccumulatePass runs.
inline MomentsView read_history(const FrameContext& frame) {
  const MomentsView inherited = read_moments(frame, kInherited);
  return inherited.mean.empty() ? read_moments(frame, kMoments) : inherited;
}

}  // namespace relume
