#include "techniques/svgf/svgf_pass.h"

#include "techniques/features/features_pass.h"
#include "techniques/svgf/svgf.h"

namespace relume {
namespace {

AtrousPicture picture_of(std::vector<float>& values, const FrameContext& frame) {
  return {mutable_view_of(values), frame.width(), frame.height()};
}

}  // namespace

PassDeclaration SvgfPass::declaration() const {
  return {
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
}

bool SvgfPass::run(const FrameContext& frame) {
  accumulate(frame);
  prepare(frame);
  filter(frame);
  present(frame);
  return true;
}

// None of these is to be stopped: the frame's samples have joined the mean by now.

void SvgfPass::accumulate(const FrameContext& frame) {
  SvgfAccumulateKernel kernel;
  kernel.history = light_history(frame, {"svgf-light", "svgf-samples"}, settings_.history);
  kernel.history.discounts = change_.discounts(frame, kernel.history);
  kernel.moments_before = frame.previous<const Vec2>("svgf-moments");
  kernel.moments = frame.view<Vec2>("svgf-moments");
  launch(frame.backend, "svgf-accumulate", kernel, frame.width(), frame.height());
}

void SvgfPass::prepare(const FrameContext& frame) {
  features_.resize(AtrousPicture::size(kAtrousPlanes, frame.width(), frame.height()));
  light_.resize(AtrousPicture::size(kAtrousChannels, frame.width(), frame.height()));
  filtered_.resize(light_.size());
  SvgfPrepareKernel kernel;
  kernel.position = frame.view<const Vec3>("feature-position");
  kernel.normal = frame.view<const Vec3>("feature-normal");
  kernel.albedo = frame.view<const Rgb>("feature-albedo");
  kernel.depth = frame.view<const float>("feature-depth");
  kernel.light = frame.view<const Rgb>("svgf-light");
  kernel.moments = frame.view<const Vec2>("svgf-moments");
  kernel.count = frame.view<const uint32_t>("svgf-samples");
  kernel.features = picture_of(features_, frame);
  kernel.planes = picture_of(light_, frame);
  kernel.cone_width = frame.scene.camera.cone_width();
  kernel.cone_spread = frame.scene.camera.cone_spread();
  kernel.width = frame.width();
  kernel.height = frame.height();
  launch(frame.backend, "svgf-prepare", kernel, frame.width(), frame.height());
}

/// Leaves the result in light_.
void SvgfPass::filter(const FrameContext& frame) {
  for (int level = 0; level < settings_.levels; ++level) {
    AtrousKernel kernel;
    kernel.features = picture_of(features_, frame);
    kernel.light = picture_of(light_, frame);
    kernel.filtered = picture_of(filtered_, frame);
    kernel.step = 1u << level;
    kernel.plane_tolerance = settings_.plane_tolerance;
    kernel.light_tolerance = settings_.light_tolerance;
    launch(frame.backend, "svgf-filter", kernel, frame.width(), frame.height());
    light_.swap(filtered_);
  }
}

void SvgfPass::present(const FrameContext& frame) {
  SvgfPresentKernel kernel;
  kernel.samples = surface_light(frame);
  kernel.filtered = picture_of(light_, frame);
  kernel.shown = frame.view<Rgb>("svgf-shown");
  kernel.width = frame.width();
  launch(frame.backend, "svgf-present", kernel, frame.width(), frame.height());
  finish_picture(frame, {"svgf-present", "svgf-shown", "svgf-picture", "svgf-samples"}, settings_.history.newest);
}

}  // namespace relume
