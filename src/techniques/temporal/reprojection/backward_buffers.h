// Creates a backward reprojection from the frame's buffers.
#pragma once

#include "frame/frame_context.h"
#include "techniques/temporal/reprojection/backward.h"

namespace relume {

inline BackwardReprojection backward_reprojection(const FrameContext& frame, const SurfaceBuffers& buffers) {
  return {.motion = frame.read(buffers.motion),
          .came_from = frame.read(buffers.previous),
          .normal = frame.read(buffers.normal),
          .depth = frame.read(buffers.depth),
          .surface = frame.read(buffers.surface),
          .previous_position = frame.previous(buffers.position),
          .previous_normal = frame.previous(buffers.normal),
          .previous_surface = frame.previous(buffers.surface),
          .width = frame.width(),
          .height = frame.height()};
}

}  // namespace relume
