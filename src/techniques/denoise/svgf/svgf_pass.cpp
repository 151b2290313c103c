#include "techniques/denoise/svgf/svgf_pass.h"

#include "techniques/denoise/shared/denoiser_buffers.h"
#include "techniques/denoise/svgf/atrous_levels.h"
#include "techniques/denoise/svgf/svgf.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kSvgfLight{"svgf-light"};
constexpr BufferKey<Vec2> kSvgfMoments{"svgf-moments"};
constexpr BufferKey<uint32_t> kSvgfSamples{"svgf-samples"};
constexpr BufferKey<Rgb> kSvgfImage{"svgf-image"};
constexpr BufferKey<Rgb> kSvgfShown{"svgf-shown"};

constexpr BufferKey<Rgb> kSvgfSpecular{"svgf-specular"};
constexpr BufferKey<Vec2> kSvgfSpecularMoments{"svgf-specular-moments"};
constexpr BufferKey<uint32_t> kSvgfSpecularSamples{"svgf-specular-samples"};
constexpr BufferKey<Rgb> kSvgfSpecularImage{"svgf-specular-image"};
constexpr BufferKey<Rgb> kSvgfSpecularShown{"svgf-specular-shown"};

/// Features and histories of one part of the light.
struct PartBuffers {
  BufferKey<Rgb> light;
  BufferKey<Vec2> moments;
  BufferKey<uint32_t> samples;
  BufferKey<Vec3> position;
  BufferKey<Vec3> normal;
  BufferKey<Rgb> albedo;
  BufferKey<float> depth;
};

PartBuffers buffers_of(LightPart part) {
  if (part == LightPart::specular) {
    return {kSvgfSpecular,      kSvgfSpecularMoments, kSvgfSpecularSamples, kReflection.position,
            kReflection.normal, kSpecularAlbedo,      kReflection.depth};
  }
  return {kSvgfLight,        kSvgfMoments,    kSvgfSamples,
          kFeature.position, kFeature.normal, part == LightPart::diffuse ? kDiffuseAlbedo : kFeatureAlbedo,
          kFeature.depth};
}

void add_parts(PassDeclaration& declaration) {
  declaration.owns.push_back(denoiser_history(kSvgfSpecular, "accumulated specular light"));
  declaration.owns.push_back(
      denoiser_history(kSvgfSpecularMoments, "means of the luminance of svgf-specular and of its square"));
  declaration.owns.push_back(denoiser_history(kSvgfSpecularSamples, "number of samples in svgf-specular"));
  declaration.owns.push_back(denoiser_history(kSvgfSpecularImage, "accumulated specular part of the denoised image"));
  declaration.owns.push_back({.id = kSvgfSpecularShown, .help = "specular part of this frame's image"});
  add_split_buffers(declaration.reads);
}

AtrousLevels levels_of(const SvgfSettings& settings, const FrameContext& frame) {
  return {frame.width(), frame.height(), settings.levels, settings.plane_tolerance, settings.light_tolerance};
}

}  // namespace

PassDeclaration SvgfPass::declaration() const {
  PassDeclaration declaration{
      .name = "svgf",
      .stage = Stage::denoise,
      .owns = {denoiser_history(kSvgfLight, "accumulated light at the surface, without its albedo"),
               denoiser_history(kSvgfMoments, "means of the luminance of svgf-light and of its square"),
               denoiser_history(kSvgfSamples, "number of samples in svgf-light"),
               denoiser_history(kSvgfImage, "accumulated denoised images"),
               denoised_buffer(),
               unfiltered_buffer(),
               filtered_share_buffer(),
               {.id = kSvgfShown, .help = "this frame's denoised image"}},
      .reads = feature_buffers(),
      .reads_if_any = {kAllocation, kFilteredCaustics}};
  if (split_) add_parts(declaration);
  return declaration;
}

bool SvgfPass::run(const FrameContext& frame) {
  const LightPart parts[] = {split_ ? LightPart::diffuse : LightPart::whole, LightPart::specular};
  if (split_) reflecting_.begin_frame(frame, scratch_);
  if (!find_changes(frame)) return false;
  const size_t count = split_ && reflecting_.now() ? 2 : 1;
  for (size_t i = 0; i < count; ++i) {
    if (!accumulate(frame, parts[i]) || !prepare(frame, parts[i])) return false;
    if (!levels_of(settings_, frame).filter(frame, "svgf-filter", features_, light_[i], filtered_)) return false;
  }
  if (!split_) return present(frame);
  if (!reflecting_.now()) clear_specular(frame);
  return present_parts(frame);
}

void SvgfPass::clear_specular(const FrameContext& frame) const {
  clear_buffer(frame, kSvgfSpecularSamples);
  clear_buffer(frame, kSvgfSpecularShown);
  clear_buffer(frame, kSvgfSpecularImage);
}

bool SvgfPass::accumulate(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  SvgfAccumulateKernel kernel;
  kernel.history = light_history(frame, {buffers.light, buffers.samples}, settings_.history, part);
  limit_history(frame, part, kernel.history);
  kernel.moments_before = frame.previous(buffers.moments);
  kernel.moments = frame.write(buffers.moments);
  return frame.launch_or_stop("svgf-accumulate", kernel);
}

void SvgfPass::limit_history(const FrameContext& frame, LightPart part, LightHistory& history) {
  history.discounts = change_[place_of(part)].discounts(frame, history);
}

bool SvgfPass::prepare(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  Array<float>& light = light_[place_of(part)];
  const AtrousLevels levels = levels_of(settings_, frame);
  levels.resize(frame.backend, "svgf-prepare", features_, kAtrousPlanes);
  levels.resize(frame.backend, "svgf-prepare", light, kAtrousChannels);
  levels.resize(frame.backend, "svgf-prepare", filtered_, kAtrousChannels);
  SvgfPrepareKernel kernel;
  kernel.position = frame.read(buffers.position);
  kernel.normal = frame.read(buffers.normal);
  kernel.albedo = frame.read(buffers.albedo);
  kernel.depth = frame.read(buffers.depth);
  kernel.light = frame.read(buffers.light);
  kernel.moments = frame.read(buffers.moments);
  kernel.count = frame.read(buffers.samples);
  kernel.features = levels.image(features_);
  kernel.planes = levels.image(light);
  kernel.cone_width = frame.scene.camera.cone_width();
  kernel.cone_spread = frame.scene.camera.cone_spread();
  kernel.correlated_frames = static_cast<float>(frame.correlated_frames);
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("svgf-prepare", kernel);
}

bool SvgfPass::present(const FrameContext& frame) {
  SvgfPresentKernel kernel;
  kernel.samples = surface_light(frame);
  kernel.filtered = levels_of(settings_, frame).image(light_[0]);
  kernel.shown = frame.write(kSvgfShown);
  kernel.width = frame.width();
  frame.launch("svgf-present", kernel);
  return finish_image(frame, scratch_, {"svgf-present", kSvgfShown, kSvgfImage, kSvgfSamples},
                      settings_.history.newest);
}

bool SvgfPass::present_parts(const FrameContext& frame) {
  SvgfPresentPartsKernel kernel;
  kernel.samples = {surface_light(frame, LightPart::diffuse), frame.read(kSpecularAlbedo)};
  kernel.diffuse = levels_of(settings_, frame).image(light_[0]);
  kernel.specular = levels_of(settings_, frame).image(light_[1]);
  kernel.shown = frame.write(kSvgfShown);
  kernel.shown_specular = frame.write(kSvgfSpecularShown);
  kernel.width = frame.width();
  frame.launch("svgf-present", kernel);
  ImageBuffers buffers{"svgf-present", kSvgfShown, kSvgfImage, kSvgfSamples};
  if (reflecting_.recently()) buffers.specular = {kSvgfSpecularShown, kSvgfSpecularImage, kSvgfSpecularSamples};
  return finish_image(frame, scratch_, buffers, settings_.history.newest);
}

}  // namespace relume
