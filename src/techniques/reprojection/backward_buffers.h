// Where passes get a backward reprojection from.
#pragma once

#include <string_view>

#include "pipeline/frame_context.h"
#include "techniques/reprojection/backward.h"

namespace relume {

/// Buffers that say what pixels show, by name. Position, normal and surface are double-buffered.
struct SurfaceBuffers {
  std::string_view motion;
  std::string_view previous;  ///< where the surface was one frame ago
  std::string_view position;
  std::string_view normal;
  std::string_view depth;
  std::string_view surface;
};

inline BackwardReprojection backward_reprojection(const FrameContext& frame, const SurfaceBuffers& buffers) {
  return {.motion = frame.view<const Vec2>(buffers.motion),
          .came_from = frame.view<const Vec3>(buffers.previous),
          .normal = frame.view<const Vec3>(buffers.normal),
          .depth = frame.view<const float>(buffers.depth),
          .surface = frame.view<const uint32_t>(buffers.surface),
          .previous_position = frame.previous<const Vec3>(buffers.position),
          .previous_normal = frame.previous<const Vec3>(buffers.normal),
          .previous_surface = frame.previous<const uint32_t>(buffers.surface),
          .width = frame.width(),
          .height = frame.height()};
}

}  // namespace relume
