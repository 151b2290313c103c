#include "techniques/denoise/asvgf/asvgf_pass.h"

#include "frame/primitives/fill.h"
#include "techniques/denoise/asvgf/adaptive_alpha.h"

namespace relume {
namespace {

AtrousImage strata_of(Array<float>& values, const FrameContext& frame) {
  return {values.mutable_view(), strata(frame.width()), strata(frame.height())};
}

}  // namespace

void AsvgfPass::configure(const AsvgfSettings& settings) {
  settings_ = settings;
  SvgfPass::configure(svgf_settings(settings, gradients_ != nullptr));
}

PassDeclaration AsvgfPass::declaration() const {
  PassDeclaration declaration = SvgfPass::declaration();
  declaration.name = "asvgf";
  if (!gradients_) return declaration;
  declaration.owns.push_back({.id = kAsvgfLambda,
                              .help = "relative change of light since the previous frame, which shortens the history",
                              .display = BufferDisplay::value});
  return declaration;
}

size_t AsvgfPass::memory_bytes() const {
  return SvgfPass::memory_bytes() + features_.memory_bytes() + planes_.memory_bytes() + filtered_.memory_bytes();
}

bool AsvgfPass::find_changes(const FrameContext& frame) {
  if (!gradients_) return true;
  if (!gradients_->traced()) return fill(frame.backend, "asvgf-filter", frame.write(kAsvgfLambda), 0.0f);
  if (!prepare_gradients(frame) || !filter_gradients(frame)) return false;
  LambdaKernel kernel;
  kernel.filtered = strata_of(planes_, frame);
  kernel.lambdas = frame.write(kAsvgfLambda);
  kernel.antilag = settings_.antilag;
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("asvgf-filter", kernel, {kernel.filtered.width, kernel.filtered.height});
}

void AsvgfPass::limit_history(const FrameContext& frame, LightPart part, LightHistory& history) {
  if (!gradients_) return SvgfPass::limit_history(frame, part, history);
  if (gradients_->traced()) history.lambdas = frame.read(kAsvgfLambda);
}

bool AsvgfPass::prepare_gradients(const FrameContext& frame) {
  const auto size_of = [&](uint32_t planes) {
    return AtrousImage::size(planes, strata(frame.width()), strata(frame.height()));
  };
  const auto resize = [&](Array<float>& image, uint32_t planes) {
    if (image.size() != size_of(planes)) relume::resize(frame.backend, "asvgf-filter", image, size_of(planes));
  };
  resize(features_, kAtrousPlanes);
  resize(planes_, kAtrousChannels);
  resize(filtered_, kAtrousChannels);
  PrepareGradientsKernel kernel;
  kernel.gradients = gradients_->gradients();
  kernel.position = frame.read(kFeature.position);
  kernel.normal = frame.read(kFeature.normal);
  kernel.depth = frame.read(kFeature.depth);
  kernel.surface = frame.read(kFeature.surface);
  kernel.features = strata_of(features_, frame);
  kernel.planes = strata_of(planes_, frame);
  kernel.cone_width = frame.scene.camera.cone_width();
  kernel.cone_spread = frame.scene.camera.cone_spread();
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("asvgf-filter", kernel, {kernel.features.width, kernel.features.height});
}

/// Replaces the planes by the result.
bool AsvgfPass::filter_gradients(const FrameContext& frame) {
  for (int level = 0; level < settings_.gradient_levels; ++level) {
    AtrousKernel kernel;
    kernel.features = strata_of(features_, frame);
    kernel.light = strata_of(planes_, frame);
    kernel.filtered = strata_of(filtered_, frame);
    kernel.step = 1u << level;
    kernel.plane_tolerance = settings_.plane_tolerance;
    kernel.light_tolerance = kAnyLight;
    if (!frame.launch_or_stop("asvgf-filter", kernel, {kernel.light.width, kernel.light.height})) return false;
    planes_.swap(filtered_);
  }
  return true;
}

}  // namespace relume
