#include "techniques/denoise/bmfr/bmfr_pass.h"

#include <algorithm>

#include "techniques/denoise/bmfr/bmfr.h"
#include "techniques/denoise/bmfr/regression_kernel.h"
#include "techniques/denoise/shared/denoiser_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kBmfrLight{"bmfr-light"};
constexpr BufferKey<float> kBmfrSquare{"bmfr-square"};
constexpr BufferKey<uint32_t> kBmfrSamples{"bmfr-samples"};
constexpr BufferKey<Rgb> kBmfrFit{"bmfr-fit"};
constexpr BufferKey<Rgb> kBmfrImage{"bmfr-image"};
constexpr BufferKey<Rgb> kBmfrFitHistory{"bmfr-fit-history"};
constexpr BufferKey<Rgb> kBmfrShown{"bmfr-shown"};
constexpr BufferKey<uint32_t> kBmfrAge{"bmfr-age"};

constexpr BufferKey<Rgb> kBmfrSpecular{"bmfr-specular"};
constexpr BufferKey<float> kBmfrSpecularSquare{"bmfr-specular-square"};
constexpr BufferKey<uint32_t> kBmfrSpecularSamples{"bmfr-specular-samples"};
constexpr BufferKey<Rgb> kBmfrSpecularFit{"bmfr-specular-fit"};
constexpr BufferKey<Rgb> kBmfrSpecularImage{"bmfr-specular-image"};
constexpr BufferKey<Rgb> kBmfrSpecularFitHistory{"bmfr-specular-fit-history"};
constexpr BufferKey<Rgb> kBmfrSpecularShown{"bmfr-specular-shown"};
constexpr BufferKey<uint32_t> kBmfrSpecularAge{"bmfr-specular-age"};

/// Fits averaged in a frame without a history: the first, and one after a cut.
constexpr uint32_t kFirstFits = 8;
/// Fits averaged in a frame with changes of light, where regions discard earlier fits.
constexpr uint32_t kFitsOfChangedLight = 4;

/// Radical inverse of `i` in `base`, scaled to [0, kBlockSize).
uint32_t shift_of(uint32_t i, uint32_t base) {
  float value = 0;
  float digit = 1;
  for (; i > 0; i /= base) value += static_cast<float>(i % base) * (digit /= static_cast<float>(base));
  return std::min(static_cast<uint32_t>(value * kBlockSize), kBlockSize - 1);
}

/// Features and histories of one part of the light.
struct PartBuffers {
  BufferKey<Rgb> light;
  BufferKey<float> square;
  BufferKey<uint32_t> samples;
  BufferKey<Rgb> fit;
  BufferKey<Rgb> fit_history;
  BufferKey<uint32_t> age;
  BufferKey<Vec3> position;
  BufferKey<Vec3> normal;
  BufferKey<Rgb> albedo;
};

PartBuffers buffers_of(LightPart part) {
  if (part == LightPart::specular) {
    return {kBmfrSpecular,    kBmfrSpecularSquare,  kBmfrSpecularSamples, kBmfrSpecularFit, kBmfrSpecularFitHistory,
            kBmfrSpecularAge, kReflection.position, kReflection.normal,   kSpecularAlbedo};
  }
  return {kBmfrLight,        kBmfrSquare,     kBmfrSamples,
          kBmfrFit,          kBmfrFitHistory, kBmfrAge,
          kFeature.position, kFeature.normal, part == LightPart::diffuse ? kDiffuseAlbedo : kFeatureAlbedo};
}

BufferDescription scratch(const BufferId& id, const char* help) { return {.id = id, .help = help}; }

void add_parts(PassDeclaration& declaration) {
  for (const BufferDescription& buffer :
       {denoiser_history(kBmfrSpecular, "accumulated specular light"),
        denoiser_history(kBmfrSpecularSquare, "mean squared luminance of the samples in bmfr-specular"),
        denoiser_history(kBmfrSpecularSamples, "number of samples in bmfr-specular"),
        denoiser_history(kBmfrSpecularFit, "specular light, fitted by features"),
        denoiser_history(kBmfrSpecularImage, "accumulated specular part of the denoised image"),
        scratch(kBmfrSpecularFitHistory, "bmfr-specular-fit of the previous frame, reprojected"),
        scratch(kBmfrSpecularShown, "specular part of this frame's image"),
        scratch(kBmfrSpecularAge, "number of samples in the reprojected history")})
    declaration.owns.push_back(buffer);
  add_split_buffers(declaration.reads);
}

}  // namespace

PassDeclaration BmfrPass::declaration() const {
  PassDeclaration declaration{
      .name = "bmfr",
      .stage = Stage::denoise,
      .owns = {denoiser_history(kBmfrLight, "accumulated light at the surface, without its albedo"),
               denoiser_history(kBmfrSquare, "mean squared luminance of the samples in bmfr-light"),
               denoiser_history(kBmfrSamples, "number of samples in bmfr-light"),
               denoiser_history(kBmfrFit, "light at the surface, fitted by features"),
               denoiser_history(kBmfrImage, "accumulated denoised images"), denoised_buffer(), unfiltered_buffer(),
               filtered_share_buffer(), scratch(kBmfrFitHistory, "bmfr-fit of the previous frame, reprojected"),
               scratch(kBmfrShown, "this frame's denoised image"),
               scratch(kBmfrAge, "number of samples in the reprojected history")},
      .reads = feature_buffers(),
      .reads_if_any = {kAllocation, kFilteredCaustics}};
  if (split_) add_parts(declaration);
  return declaration;
}

bool BmfrPass::run(const FrameContext& frame) {
  noise_.resize(kBlockNoise, kUninitialized);
  const BlockNoiseKernel noise{noise_.mutable_view(), frame.number};
  frame.launch("bmfr-fit", noise, {kBlockPixels, kBlockFeatures - 1});
  const LightPart parts[] = {split_ ? LightPart::diffuse : LightPart::whole, LightPart::specular};
  if (split_) reflecting_.begin_frame(frame, scratch_);
  const size_t count = split_ && reflecting_.now() ? 2 : 1;
  for (size_t i = 0; i < count; ++i) accumulate(frame, parts[i]);
  for (size_t i = 0; i < count; ++i) {
    if (!fit(frame, parts[i])) return false;
  }
  if (!split_) return present(frame);
  if (!reflecting_.now()) clear_specular(frame);
  return present_parts(frame);
}

void BmfrPass::clear_specular(const FrameContext& frame) const {
  clear_buffer(frame, kBmfrSpecularSamples);
  clear_buffer(frame, kBmfrSpecularAge);
  clear_buffer(frame, kBmfrSpecularFitHistory);
  clear_buffer(frame, kBmfrSpecularFit);
  clear_buffer(frame, kBmfrSpecularShown);
  clear_buffer(frame, kBmfrSpecularImage);
}

void BmfrPass::accumulate(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  BmfrAccumulateKernel kernel;
  kernel.history = light_history(frame, {buffers.light, buffers.samples}, settings_.history, part);
  kernel.history.least_share = settings_.alpha;
  kernel.history.discounts = change_[part == LightPart::specular ? 1 : 0].discounts(frame, kernel.history);
  kernel.fitted_before = frame.previous(buffers.fit);
  kernel.square_before = frame.previous(buffers.square);
  kernel.fitted_history = frame.write(buffers.fit_history);
  kernel.square = frame.write(buffers.square);
  kernel.age = frame.write(buffers.age);
  frame.launch("bmfr-accumulate", kernel);
}

bool BmfrPass::fit(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  BlockRegressionKernel kernel;
  kernel.position = frame.read(buffers.position);
  kernel.normal = frame.read(buffers.normal);
  kernel.albedo = frame.read(buffers.albedo);
  kernel.light = frame.read(buffers.light);
  kernel.samples = frame.read(buffers.samples);
  kernel.square = frame.read(buffers.square);
  kernel.noise = noise_.view();
  kernel.fitted = frame.write(buffers.fit);
  kernel.noise_scale = settings_.noise;
  kernel.detail = settings_.detail;
  kernel.most_samples = independent_samples(settings_.alpha);
  kernel.width = frame.width();
  kernel.height = frame.height();
  const Grid blocks{BlockRegressionKernel::blocks(frame.width()), BlockRegressionKernel::blocks(frame.height()), 1};
  // Without earlier fits, the edges of blocks would show.
  uint32_t fits = 1;
  if (includes(frame.changes, Change::geometry | Change::lights)) fits = kFitsOfChangedLight;
  if (lacks_history(frame, scratch_, kBmfrSamples,
                    split_ && reflecting_.now() ? kBmfrSpecularSamples : BufferKey<uint32_t>{}))
    fits = kFirstFits;
  for (uint32_t i = 0; i < fits; ++i) {
    kernel.shift_x = shift_of(frame.number + i, 2);
    kernel.shift_y = shift_of(frame.number + i, 3);
    kernel.share = 1.0f / static_cast<float>(i + 1);
    if (!frame.launch_or_stop("bmfr-fit", kernel, blocks)) return false;
  }
  return true;
}

FitHistory BmfrPass::fit_history(const FrameContext& frame, LightPart part) const {
  const PartBuffers buffers = buffers_of(part);
  return {.albedo = frame.read(buffers.albedo),
          .age = frame.read(buffers.age),
          .history = frame.read(buffers.fit_history),
          .fitted = frame.write(buffers.fit),
          .max_fits = static_cast<uint32_t>(settings_.max_fits)};
}

bool BmfrPass::present(const FrameContext& frame) {
  BmfrPresentKernel kernel;
  kernel.samples = surface_light(frame);
  kernel.fits = fit_history(frame, LightPart::whole);
  kernel.shown = frame.write(kBmfrShown);
  kernel.width = frame.width();
  frame.launch("bmfr-present", kernel);
  return finish_image(frame, scratch_, {"bmfr-present", kBmfrShown, kBmfrImage, kBmfrSamples},
                      settings_.history.newest);
}

bool BmfrPass::present_parts(const FrameContext& frame) {
  BmfrPresentPartsKernel kernel;
  kernel.samples = {surface_light(frame, LightPart::diffuse), frame.read(kSpecularAlbedo)};
  kernel.diffuse = fit_history(frame, LightPart::diffuse);
  kernel.specular = fit_history(frame, LightPart::specular);
  kernel.shown = frame.write(kBmfrShown);
  kernel.shown_specular = frame.write(kBmfrSpecularShown);
  kernel.width = frame.width();
  frame.launch("bmfr-present", kernel);
  ImageBuffers buffers{"bmfr-present", kBmfrShown, kBmfrImage, kBmfrSamples};
  if (reflecting_.recently()) buffers.specular = {kBmfrSpecularShown, kBmfrSpecularImage, kBmfrSpecularSamples};
  return finish_image(frame, scratch_, buffers, settings_.history.newest);
}

}  // namespace relume
