#include "techniques/denoise/caustic_layer/caustic_layer_pass.h"

#include "techniques/denoise/caustic_layer/caustic_layer.h"
#include "techniques/denoise/shared/denoiser_buffers.h"
#include "techniques/denoise/svgf/atrous_levels.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kCausticLight{"caustic-light"};
constexpr BufferKey<float> kCausticNoise{"caustic-noise"};
constexpr BufferKey<uint32_t> kCausticLightSamples{"caustic-light-samples"};

AtrousLevels levels_of(const SvgfSettings& settings, const FrameContext& frame) {
  return {frame.width(), frame.height(), settings.levels, settings.plane_tolerance, settings.light_tolerance};
}

}  // namespace

PassDeclaration CausticLayerPass::declaration() const {
  return {.name = "caustics",
          .stage = Stage::denoise,
          .owns = {{.id = kCausticAlbedo, .help = "1 where the caustic layer is filtered, else 0"},
                   denoiser_history(kCausticLight, "caustic layer, accumulated along surfaces"),
                   denoiser_history(kCausticNoise, "mean variance of the luminance of a frame's caustic layer"),
                   denoiser_history(kCausticLightSamples, "number of samples in caustic-light"),
                   {.id = kFilteredCaustics, .help = "this frame's filtered caustic layer"}},
          .reads = {kRadiance, kCausticRadiance, kCausticDifference, kShownEmission, kFeatureAlbedo, kFeature.position,
                    kFeature.previous, kFeature.normal, kFeature.depth, kFeature.motion, kFeature.surface},
          .reads_if_any = {kAllocation}};
}

bool CausticLayerPass::run(const FrameContext& frame) {
  const CausticAlbedoKernel mark{frame.read(kFeatureAlbedo), frame.write(kCausticAlbedo), frame.width()};
  if (!frame.launch_or_stop("caustics-accumulate", mark) || !accumulate(frame) || !prepare(frame)) return false;
  if (!levels_of(settings_, frame).filter(frame, "caustics-filter", features_, light_, filtered_)) return false;
  return present(frame);
}

bool CausticLayerPass::accumulate(const FrameContext& frame) {
  CausticAccumulateKernel kernel;
  kernel.history = light_history(frame, {kCausticLight, kCausticLightSamples}, settings_.history, LightPart::caustics);
  kernel.history.discounts = change_.discounts(frame, kernel.history);
  kernel.differences = frame.read(kCausticDifference);
  kernel.noise_before = frame.previous(kCausticNoise);
  kernel.noise = frame.write(kCausticNoise);
  return frame.launch_or_stop("caustics-accumulate", kernel);
}

bool CausticLayerPass::prepare(const FrameContext& frame) {
  const AtrousLevels levels = levels_of(settings_, frame);
  levels.resize(frame.backend, "caustics-prepare", features_, kAtrousPlanes);
  levels.resize(frame.backend, "caustics-prepare", light_, kAtrousChannels);
  levels.resize(frame.backend, "caustics-prepare", filtered_, kAtrousChannels);
  CausticPrepareKernel kernel;
  kernel.position = frame.read(kFeature.position);
  kernel.normal = frame.read(kFeature.normal);
  kernel.albedo = frame.read(kCausticAlbedo);
  kernel.depth = frame.read(kFeature.depth);
  kernel.light = frame.read(kCausticLight);
  kernel.noise = frame.read(kCausticNoise);
  kernel.count = frame.read(kCausticLightSamples);
  kernel.features = levels.image(features_);
  kernel.planes = levels.image(light_);
  kernel.cone_width = frame.scene.camera.cone_width();
  kernel.cone_spread = frame.scene.camera.cone_spread();
  kernel.correlated_frames = static_cast<float>(frame.correlated_frames);
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("caustics-prepare", kernel);
}

bool CausticLayerPass::present(const FrameContext& frame) {
  CausticPresentKernel kernel;
  kernel.albedo = frame.read(kCausticAlbedo);
  kernel.filtered = levels_of(settings_, frame).image(light_);
  kernel.caustics = frame.write(kFilteredCaustics);
  kernel.width = frame.width();
  return frame.launch_or_stop("caustics-present", kernel);
}

}  // namespace relume
