#include "techniques/reuse/reservoir/reuse_pass.h"

#include <fmt/format.h>

namespace relume {

std::vector<BufferDescription> reuse_descriptions(const BufferId& reservoirs, const BufferId& history,
                                                  const BufferId& receivers, std::string_view content, Change reset) {
  return {{.id = reservoirs, .help = fmt::format("reservoirs of {} before the reuse of neighbouring pixels", content)},
          {.id = history,
           .help = fmt::format("reservoirs of {} that the next frame reuses", content),
           .persistent = true,
           .double_buffered = true,
           .reset = reset},
          {.id = receivers,
           .help = fmt::format("primary hits of the reservoirs of {}", content),
           .persistent = true,
           .double_buffered = true,
           .reset = reset}};
}

void read_surfaces(PassDeclaration& declaration) {
  for (const BufferId& id : {BufferId(kSurface.motion), BufferId(kSurface.previous), BufferId(kSurface.position),
                             BufferId(kSurface.normal), BufferId(kSurface.depth), BufferId(kSurface.surface)})
    declaration.reads.push_back(id);
}

NeighbourSearch neighbour_search(const FrameContext& frame, int neighbours, float radius) {
  return {.normal = frame.read(kSurface.normal),
          .depth = frame.read(kSurface.depth),
          .count = static_cast<uint32_t>(neighbours),
          .radius = radius,
          .width = frame.width(),
          .height = frame.height()};
}

bool reservoirs_hold(const FrameContext& frame) {
  const CameraView& now = frame.scene.camera;
  const CameraView& before = frame.scene.previous_camera;
  const bool same_cones = now.cone_width() == before.cone_width() && now.cone_spread() == before.cone_spread();
  return same_cones && (frame.changes | Change::camera) == Change::camera;
}

SampledPixels sampled_pixels(const FrameContext& frame) { return {frame.read(kAllocation)}; }

ReuseImage reuse_image(const FrameContext& frame) {
  return {frame.write(kRadiance), frame.write(kRadianceSpecular), frame.write(kRays), sampled_pixels(frame)};
}

}  // namespace relume
