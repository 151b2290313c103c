#include "techniques/primary_hits/primary_hits_pass.h"

#include "techniques/primary_hits/primary_hits.h"

namespace relume {

PassDeclaration PrimaryHitsPass::declaration() const {
  return {
      .name = "gbuffer",
      .stage = only_samples_ ? Stage::sampled_hits : Stage::hits,
      .owns = {{.name = "primary-hits", .type = BufferType::hit, .help = "hit of the camera ray of this frame"}},
      .reads_if_any = only_samples_ ? std::vector<std::string_view>{"allocation"} : std::vector<std::string_view>{}};
}

bool PrimaryHitsPass::run(const FrameContext& frame) {
  PrimaryHitsKernel kernel{frame.scene.accel, frame.scene.camera, frame.index, {}, {}, frame.width()};
  kernel.hits = frame.view<Hit>("primary-hits");
  if (only_samples_) kernel.allocation = frame.view<const uint32_t>("allocation");
  return frame.launch("gbuffer", kernel);
}

BufferDescription surface_buffer(const char* name, BufferType type, const char* help, bool double_buffered,
                                 std::string_view channels) {
  return {.name = name,
          .type = type,
          .help = help,
          .persistent = double_buffered,
          .double_buffered = double_buffered,
          .display = BufferDisplay::value,
          .channels = channels};
}

PassDeclaration SurfacePass::declaration() const {
  return {
      .name = "surface",
      .stage = Stage::gbuffer,
      .owns = {surface_buffer("surface-position", BufferType::rgb32f, "first hit, metres", true, "XYZ"),
               surface_buffer("surface-previous", BufferType::rgb32f, "where it was one frame ago, metres", false,
                              "XYZ"),
               surface_buffer("surface-normal", BufferType::rgb32f, "shading normal of the first hit", true, "XYZ"),
               surface_buffer("surface-albedo", BufferType::rgb32f, "directional albedo of the first hit", false),
               surface_buffer("surface-depth", BufferType::f32, "distance of the first hit, metres", false, "Z"),
               surface_buffer("surface-motion", BufferType::vec2f,
                              "motion since the previous frame, pixels; 65504 where it lay behind its camera", false),
               surface_buffer("surface-instance", BufferType::u32, "instance of the first hit", true)},
      .reads = {"primary-hits"}};
}

bool SurfacePass::run(const FrameContext& frame) {
  SurfaceKernel kernel;
  kernel.scene = frame.scene;
  kernel.index = frame.index;
  kernel.hits = frame.view<const Hit>("primary-hits");
  kernel.position = frame.view<Vec3>("surface-position");
  kernel.previous = frame.view<Vec3>("surface-previous");
  kernel.normal = frame.view<Vec3>("surface-normal");
  kernel.albedo = frame.view<Rgb>("surface-albedo");
  kernel.depth = frame.view<float>("surface-depth");
  kernel.motion = frame.view<Vec2>("surface-motion");
  kernel.surface = frame.view<uint32_t>("surface-instance");
  kernel.width = frame.width();
  return frame.launch("surface", kernel);
}

PassDeclaration AuxiliaryPass::declaration() const {
  const auto buffer = [](const char* name, BufferType type, const char* help, std::string_view channels = "",
                         BufferDisplay display = BufferDisplay::mean) {
    return BufferDescription{.name = name,
                             .type = type,
                             .help = help,
                             .persistent = true,
                             .reset = Change::any,
                             .display = display,
                             .channels = channels};
  };
  return {.name = "auxiliary",
          .stage = Stage::present,
          .owns = {buffer("albedo", BufferType::rgb32f, "directional albedo of the first hit"),
                   buffer("normal", BufferType::rgb32f, "shading normal of the first hit", "XYZ"),
                   buffer("depth", BufferType::f32, "distance of the first hit, metres", "Z"),
                   buffer("motion", BufferType::vec2f,
                          "motion since the previous frame, pixels; 65504 where it lay behind its camera", "XY",
                          BufferDisplay::value)},
          .reads = {"surface-albedo", "surface-normal", "surface-depth", "surface-motion"}};
}

bool AuxiliaryPass::run(const FrameContext& frame) {
  AuxiliaryKernel kernel;
  kernel.surface_albedo = frame.view<const Rgb>("surface-albedo");
  kernel.surface_normal = frame.view<const Vec3>("surface-normal");
  kernel.surface_depth = frame.view<const float>("surface-depth");
  kernel.surface_motion = frame.view<const Vec2>("surface-motion");
  kernel.albedo = frame.view<Rgb>("albedo");
  kernel.normal = frame.view<Vec3>("normal");
  kernel.depth = frame.view<float>("depth");
  kernel.motion = frame.view<Vec2>("motion");
  kernel.first = frame.begins_picture;
  kernel.width = frame.width();
  return launch(frame.backend, "auxiliary", kernel, frame.width(), frame.height());
}

}  // namespace relume
