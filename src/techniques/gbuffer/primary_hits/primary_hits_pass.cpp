#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"

#include "techniques/gbuffer/primary_hits/primary_hits.h"

namespace relume {

PassDeclaration PrimaryHitsPass::declaration() const {
  return {.name = "gbuffer",
          .stage = only_samples_ ? Stage::sampled_hits : Stage::hits,
          .owns = {{.id = kPrimaryHits, .help = "hit of this frame's camera ray"}},
          .reads_if_any = only_samples_ ? std::vector<BufferId>{kAllocation} : std::vector<BufferId>{}};
}

bool PrimaryHitsPass::run(const FrameContext& frame) {
  PrimaryHitsKernel kernel{frame.scene, frame.index, {}, {}, frame.width()};
  kernel.hits = frame.write(kPrimaryHits);
  if (only_samples_) kernel.allocation = frame.read(kAllocation);
  return frame.launch_or_stop("gbuffer", kernel);
}

BufferDescription surface_buffer(const BufferId& id, const char* help, bool double_buffered,
                                 std::string_view channels) {
  return {.id = id,
          .help = help,
          .persistent = double_buffered,
          .double_buffered = double_buffered,
          .display = BufferDisplay::value,
          .channels = channels};
}

PassDeclaration SurfacePass::declaration() const {
  return {.name = "surface",
          .stage = Stage::gbuffer,
          .owns = {surface_buffer(kSurface.position, "position of the first hit, metres", true, "XYZ"),
                   surface_buffer(kSurface.previous, "surface-position one frame ago, metres", false, "XYZ"),
                   surface_buffer(kSurface.normal, "shading normal of the first hit", true, "XYZ"),
                   surface_buffer(kSurfaceAlbedo, "directional albedo of the first hit", false),
                   surface_buffer(kSurface.depth, "distance of the first hit, metres", false, "Z"),
                   surface_buffer(
                       kSurface.motion,
                       "motion since the previous frame, pixels; 65504 where the surface was behind the camera", false),
                   surface_buffer(kSurface.surface, "instance of the first hit", true)},
          .reads = {kPrimaryHits}};
}

bool SurfacePass::run(const FrameContext& frame) {
  SurfaceKernel kernel;
  kernel.scene = frame.scene;
  kernel.index = frame.index;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.position = frame.write(kSurface.position);
  kernel.previous = frame.write(kSurface.previous);
  kernel.normal = frame.write(kSurface.normal);
  kernel.albedo = frame.write(kSurfaceAlbedo);
  kernel.depth = frame.write(kSurface.depth);
  kernel.motion = frame.write(kSurface.motion);
  kernel.surface = frame.write(kSurface.surface);
  kernel.width = frame.width();
  return frame.launch_or_stop("surface", kernel);
}

PassDeclaration AuxiliaryPass::declaration() const {
  const auto buffer = [](const BufferId& id, const char* help, std::string_view channels = "",
                         BufferDisplay display = BufferDisplay::mean) {
    return BufferDescription{
        .id = id, .help = help, .persistent = true, .reset = Change::any, .display = display, .channels = channels};
  };
  return {.name = "auxiliary",
          .stage = Stage::present,
          .owns = {buffer(kAlbedoAov, "directional albedo of the first hit"),
                   buffer(kNormalAov, "shading normal of the first hit", "XYZ"),
                   buffer(kDepthAov, "distance of the first hit, metres", "Z"),
                   buffer(kMotionAov,
                          "motion since the previous frame, pixels; 65504 where the surface was behind the camera",
                          "XY", BufferDisplay::value)},
          .reads = {kSurfaceAlbedo, kSurface.normal, kSurface.depth, kSurface.motion}};
}

bool AuxiliaryPass::run(const FrameContext& frame) {
  AuxiliaryKernel kernel;
  kernel.surface_albedo = frame.read(kSurfaceAlbedo);
  kernel.surface_normal = frame.read(kSurface.normal);
  kernel.surface_depth = frame.read(kSurface.depth);
  kernel.surface_motion = frame.read(kSurface.motion);
  kernel.albedo = frame.write(kAlbedoAov);
  kernel.normal = frame.write(kNormalAov);
  kernel.depth = frame.write(kDepthAov);
  kernel.motion = frame.write(kMotionAov);
  kernel.first = frame.begins_image;
  kernel.width = frame.width();
  frame.launch("auxiliary", kernel);
  return true;
}

}  // namespace relume
