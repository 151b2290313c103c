#include "techniques/svgf/svgf_pass.h"

#include "techniques/features/features_pass.h"
#include "techniques/svgf/svgf.h"

namespace relume {
namespace {

/// What one part of the light is filtered by: features, and the pass's own buffers.
struct PartBuffers {
  std::string_view light;
  std::string_view moments;
  std::string_view samples;
  std::string_view position;
  std::string_view normal;
  std::string_view albedo;
  std::string_view depth;
};

PartBuffers buffers_of(LightPart part) {
  if (part == LightPart::specular) {
    return {"svgf-specular",   "svgf-specular-moments", "svgf-specular-samples", "specular-position",
            "specular-normal", "specular-albedo",       "specular-depth"};
  }
  return {"svgf-light",       "svgf-moments",   "svgf-samples",
          "feature-position", "feature-normal", part == LightPart::diffuse ? "diffuse-albedo" : "feature-albedo",
          "feature-depth"};
}

void add_parts(PassDeclaration& declaration) {
  declaration.owns.push_back(
      denoiser_history("svgf-specular", BufferType::rgb32f, "specular light, as far as samples tell"));
  declaration.owns.push_back(denoiser_history("svgf-specular-moments", BufferType::vec2f,
                                              "mean of the luminance of svgf-specular and of its square"));
  declaration.owns.push_back(denoiser_history("svgf-specular-samples", BufferType::u32, "samples in svgf-specular"));
  declaration.owns.push_back(denoiser_history("svgf-specular-picture", BufferType::rgb32f,
                                              "specular part of the filtered pictures, averaged"));
  declaration.owns.push_back(
      {.name = "svgf-specular-shown", .type = BufferType::rgb32f, .help = "specular part of this frame's picture"});
  add_split_buffers(declaration.reads);
}

AtrousPicture picture_of(std::vector<float>& values, const FrameContext& frame) {
  return {mutable_view_of(values), frame.width(), frame.height()};
}

}  // namespace

PassDeclaration SvgfPass::declaration() const {
  PassDeclaration declaration{
      .name = "svgf",
      .stage = Stage::denoise,
      .owns = {denoiser_history("svgf-light", BufferType::rgb32f, "light at the surface, as far as samples tell"),
               denoiser_history("svgf-moments", BufferType::vec2f, "mean of its luminance and of the square of that"),
               denoiser_history("svgf-samples", BufferType::u32, "samples in it"),
               denoiser_history("svgf-picture", BufferType::rgb32f, "filtered pictures, averaged"),
               denoised_buffer(),
               unfiltered_buffer(),
               filtered_share_buffer(),
               {.name = "svgf-shown", .type = BufferType::rgb32f, .help = "this frame's picture"}},
      .reads = feature_buffers(),
      .reads_if_any = {"allocation"}};
  if (split_) add_parts(declaration);
  return declaration;
}

bool SvgfPass::run(const FrameContext& frame) {
  const LightPart parts[] = {split_ ? LightPart::diffuse : LightPart::whole, LightPart::specular};
  if (split_) reflecting_.begin_frame(frame);
  const size_t count = split_ && reflecting_.now() ? 2 : 1;
  for (size_t i = 0; i < count; ++i) {
    accumulate(frame, parts[i]);
    prepare(frame, parts[i]);
    filter(frame, light_[i]);
  }
  if (!split_) {
    present(frame);
    return true;
  }
  if (!reflecting_.now()) forget_specular(frame);
  present_parts(frame);
  return true;
}

void SvgfPass::forget_specular(const FrameContext& frame) const {
  clear_buffer<uint32_t>(frame, "svgf-specular-samples");
  clear_buffer<Rgb>(frame, "svgf-specular-shown");
  clear_buffer<Rgb>(frame, "svgf-specular-picture");
}

// None of these is to be stopped: the frame's samples have joined the mean by now.

void SvgfPass::accumulate(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  SvgfAccumulateKernel kernel;
  kernel.history = light_history(frame, {buffers.light, buffers.samples}, settings_.history, part);
  kernel.history.discounts = change_[place_of(part)].discounts(frame, kernel.history);
  kernel.moments_before = frame.previous<const Vec2>(buffers.moments);
  kernel.moments = frame.view<Vec2>(buffers.moments);
  launch(frame.backend, "svgf-accumulate", kernel, frame.width(), frame.height());
}

void SvgfPass::prepare(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  std::vector<float>& light = light_[place_of(part)];
  features_.resize(AtrousPicture::size(kAtrousPlanes, frame.width(), frame.height()));
  light.resize(AtrousPicture::size(kAtrousChannels, frame.width(), frame.height()));
  filtered_.resize(light.size());
  SvgfPrepareKernel kernel;
  kernel.position = frame.view<const Vec3>(buffers.position);
  kernel.normal = frame.view<const Vec3>(buffers.normal);
  kernel.albedo = frame.view<const Rgb>(buffers.albedo);
  kernel.depth = frame.view<const float>(buffers.depth);
  kernel.light = frame.view<const Rgb>(buffers.light);
  kernel.moments = frame.view<const Vec2>(buffers.moments);
  kernel.count = frame.view<const uint32_t>(buffers.samples);
  kernel.features = picture_of(features_, frame);
  kernel.planes = picture_of(light, frame);
  kernel.cone_width = frame.scene.camera.cone_width();
  kernel.cone_spread = frame.scene.camera.cone_spread();
  kernel.width = frame.width();
  kernel.height = frame.height();
  launch(frame.backend, "svgf-prepare", kernel, frame.width(), frame.height());
}

/// Leaves the result in `light`.
void SvgfPass::filter(const FrameContext& frame, std::vector<float>& light) {
  for (int level = 0; level < settings_.levels; ++level) {
    AtrousKernel kernel;
    kernel.features = picture_of(features_, frame);
    kernel.light = picture_of(light, frame);
    kernel.filtered = picture_of(filtered_, frame);
    kernel.step = 1u << level;
    kernel.plane_tolerance = settings_.plane_tolerance;
    kernel.light_tolerance = settings_.light_tolerance;
    launch(frame.backend, "svgf-filter", kernel, frame.width(), frame.height());
    light.swap(filtered_);
  }
}

void SvgfPass::present(const FrameContext& frame) {
  SvgfPresentKernel kernel;
  kernel.samples = surface_light(frame);
  kernel.filtered = picture_of(light_[0], frame);
  kernel.shown = frame.view<Rgb>("svgf-shown");
  kernel.width = frame.width();
  launch(frame.backend, "svgf-present", kernel, frame.width(), frame.height());
  finish_picture(frame, {"svgf-present", "svgf-shown", "svgf-picture", "svgf-samples"}, settings_.history.newest);
}

void SvgfPass::present_parts(const FrameContext& frame) {
  SvgfPresentPartsKernel kernel;
  kernel.samples = {surface_light(frame, LightPart::diffuse), frame.view<const Rgb>("specular-albedo")};
  kernel.diffuse = picture_of(light_[0], frame);
  kernel.specular = picture_of(light_[1], frame);
  kernel.shown = frame.view<Rgb>("svgf-shown");
  kernel.shown_specular = frame.view<Rgb>("svgf-specular-shown");
  kernel.width = frame.width();
  launch(frame.backend, "svgf-present", kernel, frame.width(), frame.height());
  PictureBuffers buffers{"svgf-present", "svgf-shown", "svgf-picture", "svgf-samples"};
  if (reflecting_.recently())
    buffers.specular = {"svgf-specular-shown", "svgf-specular-picture", "svgf-specular-samples"};
  finish_picture(frame, buffers, settings_.history.newest);
}

}  // namespace relume
