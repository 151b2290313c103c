#include "techniques/denoise/asvgf/asvgf_pass.h"

#include "frame/primitives/fill.h"
#include "techniques/denoise/asvgf/adaptive_alpha.h"
#include "techniques/denoise/svgf/atrous_levels.h"

namespace relume {
namespace {

AtrousLevels levels_of(const AsvgfSettings& settings, const FrameContext& frame) {
  return {strata(frame.width()), strata(frame.height()), settings.gradient_levels, settings.plane_tolerance, kAnyLight};
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
  const AtrousLevels levels = levels_of(settings_, frame);
  if (!prepare_gradients(frame) || !levels.filter(frame, "asvgf-filter", features_, planes_, filtered_)) return false;
  LambdaKernel kernel;
  kernel.filtered = levels.image(planes_);
  kernel.lambdas = frame.write(kAsvgfLambda);
  kernel.antilag = settings_.antilag;
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("asvgf-filter", kernel, {levels.width, levels.height});
}

void AsvgfPass::limit_history(const FrameContext& frame, LightPart part, LightHistory& history) {
  if (!gradients_) return SvgfPass::limit_history(frame, part, history);
  if (gradients_->traced()) history.lambdas = frame.read(kAsvgfLambda);
}

bool AsvgfPass::prepare_gradients(const FrameContext& frame) {
  const AtrousLevels levels = levels_of(settings_, frame);
  levels.resize(frame.backend, "asvgf-filter", features_, kAtrousPlanes);
  levels.resize(frame.backend, "asvgf-filter", planes_, kAtrousChannels);
  levels.resize(frame.backend, "asvgf-filter", filtered_, kAtrousChannels);
  PrepareGradientsKernel kernel;
  kernel.gradients = gradients_->gradients();
  kernel.position = frame.read(kFeature.position);
  kernel.normal = frame.read(kFeature.normal);
  kernel.depth = frame.read(kFeature.depth);
  kernel.surface = frame.read(kFeature.surface);
  kernel.features = levels.image(features_);
  kernel.planes = levels.image(planes_);
  kernel.cone_width = frame.scene.camera.cone_width();
  kernel.cone_spread = frame.scene.camera.cone_spread();
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("asvgf-filter", kernel, {kernel.features.width, kernel.features.height});
}

}  // namespace relume
