#include "techniques/bmfr/bmfr_pass.h"

#include <algorithm>

#include "techniques/bmfr/bmfr.h"
#include "techniques/bmfr/regression_kernel.h"
#include "techniques/features/features_pass.h"

namespace relume {
namespace {

/// Fits that a frame without a past is the mean of: the first, and one after a cut.
constexpr uint32_t kFirstFits = 8;
/// And a frame in which the light has changed in places, which forget earlier fits.
constexpr uint32_t kFitsOfChangedLight = 4;

/// Radical inverse of `i` in `base`, in [0, kBlockSize).
uint32_t shift_of(uint32_t i, uint32_t base) {
  float value = 0;
  float digit = 1;
  for (; i > 0; i /= base) value += static_cast<float>(i % base) * (digit /= static_cast<float>(base));
  return std::min(static_cast<uint32_t>(value * kBlockSize), kBlockSize - 1);
}

/// What one part of the light is fitted by: features, and the pass's own buffers.
struct PartBuffers {
  std::string_view light;
  std::string_view square;
  std::string_view samples;
  std::string_view fit;
  std::string_view fit_history;
  std::string_view age;
  std::string_view position;
  std::string_view normal;
  std::string_view albedo;
};

PartBuffers buffers_of(LightPart part) {
  if (part == LightPart::specular) {
    return {"bmfr-specular",     "bmfr-specular-square",      "bmfr-specular-samples",
            "bmfr-specular-fit", "bmfr-specular-fit-history", "bmfr-specular-age",
            "specular-position", "specular-normal",           "specular-albedo"};
  }
  return {"bmfr-light",       "bmfr-square",      "bmfr-samples",
          "bmfr-fit",         "bmfr-fit-history", "bmfr-age",
          "feature-position", "feature-normal",   part == LightPart::diffuse ? "diffuse-albedo" : "feature-albedo"};
}

BufferDescription scratch(const char* name, BufferType type, const char* help) {
  return {.name = name, .type = type, .help = help};
}

void add_parts(PassDeclaration& declaration) {
  for (const BufferDescription& buffer :
       {denoiser_history("bmfr-specular", BufferType::rgb32f, "specular light, as far as samples tell"),
        denoiser_history("bmfr-specular-square", BufferType::f32, "mean square of the luminance of those samples"),
        denoiser_history("bmfr-specular-samples", BufferType::u32, "samples in bmfr-specular"),
        denoiser_history("bmfr-specular-fit", BufferType::rgb32f, "specular light as features explain it"),
        denoiser_history("bmfr-specular-picture", BufferType::rgb32f,
                         "specular part of the filtered pictures, averaged"),
        scratch("bmfr-specular-fit-history", BufferType::rgb32f, "bmfr-specular-fit of the frame before, where it was"),
        scratch("bmfr-specular-shown", BufferType::rgb32f, "specular part of this frame's picture"),
        scratch("bmfr-specular-age", BufferType::u32, "samples in that history")})
    declaration.owns.push_back(buffer);
  add_split_buffers(declaration.reads);
}

}  // namespace

PassDeclaration BmfrPass::declaration() const {
  PassDeclaration declaration{
      .name = "bmfr",
      .stage = Stage::denoise,
      .owns = {denoiser_history("bmfr-light", BufferType::rgb32f, "light at the surface, as far as samples tell"),
               denoiser_history("bmfr-square", BufferType::f32, "mean square of the luminance of its samples"),
               denoiser_history("bmfr-samples", BufferType::u32, "samples in it"),
               denoiser_history("bmfr-fit", BufferType::rgb32f, "light as features explain it"),
               denoiser_history("bmfr-picture", BufferType::rgb32f, "filtered pictures, averaged"), denoised_buffer(),
               unfiltered_buffer(), filtered_share_buffer(),
               scratch("bmfr-fit-history", BufferType::rgb32f, "bmfr-fit of the frame before, where it was"),
               scratch("bmfr-shown", BufferType::rgb32f, "this frame's picture"),
               scratch("bmfr-age", BufferType::u32, "samples in that history")},
      .reads = feature_buffers(),
      .reads_if_any = {"allocation"}};
  if (split_) add_parts(declaration);
  return declaration;
}

bool BmfrPass::run(const FrameContext& frame) {
  noise_.resize(kBlockNoise);
  const BlockNoiseKernel noise{mutable_view_of(noise_), frame.number};
  launch(frame.backend, "bmfr-fit", noise, kBlockPixels, kBlockFeatures - 1);
  const LightPart parts[] = {split_ ? LightPart::diffuse : LightPart::whole, LightPart::specular};
  if (split_) reflecting_.begin_frame(frame);
  const size_t count = split_ && reflecting_.now() ? 2 : 1;
  for (size_t i = 0; i < count; ++i) accumulate(frame, parts[i]);
  for (size_t i = 0; i < count; ++i) fit(frame, parts[i]);
  if (!split_) {
    present(frame);
    return true;
  }
  if (!reflecting_.now()) forget_specular(frame);
  present_parts(frame);
  return true;
}

void BmfrPass::forget_specular(const FrameContext& frame) const {
  clear_buffer<uint32_t>(frame, "bmfr-specular-samples");
  clear_buffer<uint32_t>(frame, "bmfr-specular-age");
  clear_buffer<Rgb>(frame, "bmfr-specular-fit-history");
  clear_buffer<Rgb>(frame, "bmfr-specular-fit");
  clear_buffer<Rgb>(frame, "bmfr-specular-shown");
  clear_buffer<Rgb>(frame, "bmfr-specular-picture");
}

// None of these is to be stopped: the frame's samples have joined the mean by now.

void BmfrPass::accumulate(const FrameContext& frame, LightPart part) {
  const PartBuffers buffers = buffers_of(part);
  BmfrAccumulateKernel kernel;
  kernel.history = light_history(frame, {buffers.light, buffers.samples}, settings_.history, part);
  kernel.history.least_share = settings_.alpha;
  kernel.history.discounts = change_[part == LightPart::specular ? 1 : 0].discounts(frame, kernel.history);
  kernel.fitted_before = frame.previous<const Rgb>(buffers.fit);
  kernel.square_before = frame.previous<const float>(buffers.square);
  kernel.fitted_history = frame.view<Rgb>(buffers.fit_history);
  kernel.square = frame.view<float>(buffers.square);
  kernel.age = frame.view<uint32_t>(buffers.age);
  launch(frame.backend, "bmfr-accumulate", kernel, frame.width(), frame.height());
}

void BmfrPass::fit(const FrameContext& frame, LightPart part) const {
  const PartBuffers buffers = buffers_of(part);
  BlockRegressionKernel kernel;
  kernel.position = frame.view<const Vec3>(buffers.position);
  kernel.normal = frame.view<const Vec3>(buffers.normal);
  kernel.albedo = frame.view<const Rgb>(buffers.albedo);
  kernel.light = frame.view<const Rgb>(buffers.light);
  kernel.samples = frame.view<const uint32_t>(buffers.samples);
  kernel.square = frame.view<const float>(buffers.square);
  kernel.noise = view_of(noise_);
  kernel.fitted = frame.view<Rgb>(buffers.fit);
  kernel.noise_scale = settings_.noise;
  kernel.detail = settings_.detail;
  kernel.most_samples = independent_samples(settings_.alpha);
  kernel.width = frame.width();
  kernel.height = frame.height();
  // Without fits of earlier frames the edges of blocks would show.
  uint32_t fits = 1;
  if (includes(frame.changes, Change::geometry | Change::lights)) fits = kFitsOfChangedLight;
  if (lacks_history(frame, "bmfr-samples", split_ && reflecting_.now() ? "bmfr-specular-samples" : ""))
    fits = kFirstFits;
  for (uint32_t i = 0; i < fits; ++i) {
    kernel.shift_x = shift_of(frame.number + i, 2);
    kernel.shift_y = shift_of(frame.number + i, 3);
    kernel.share = 1.0f / static_cast<float>(i + 1);
    launch(frame.backend, "bmfr-fit", kernel, BlockRegressionKernel::blocks(frame.width()),
           BlockRegressionKernel::blocks(frame.height()), {}, 1);
  }
}

FitHistory BmfrPass::fit_history(const FrameContext& frame, LightPart part) const {
  const PartBuffers buffers = buffers_of(part);
  return {.albedo = frame.view<const Rgb>(buffers.albedo),
          .age = frame.view<const uint32_t>(buffers.age),
          .history = frame.view<const Rgb>(buffers.fit_history),
          .fitted = frame.view<Rgb>(buffers.fit),
          .max_fits = static_cast<uint32_t>(settings_.max_fits)};
}

void BmfrPass::present(const FrameContext& frame) const {
  BmfrPresentKernel kernel;
  kernel.samples = surface_light(frame);
  kernel.fits = fit_history(frame, LightPart::whole);
  kernel.shown = frame.view<Rgb>("bmfr-shown");
  kernel.width = frame.width();
  launch(frame.backend, "bmfr-present", kernel, frame.width(), frame.height());
  finish_picture(frame, {"bmfr-present", "bmfr-shown", "bmfr-picture", "bmfr-samples"}, settings_.history.newest);
}

void BmfrPass::present_parts(const FrameContext& frame) const {
  BmfrPresentPartsKernel kernel;
  kernel.samples = {surface_light(frame, LightPart::diffuse), frame.view<const Rgb>("specular-albedo")};
  kernel.diffuse = fit_history(frame, LightPart::diffuse);
  kernel.specular = fit_history(frame, LightPart::specular);
  kernel.shown = frame.view<Rgb>("bmfr-shown");
  kernel.shown_specular = frame.view<Rgb>("bmfr-specular-shown");
  kernel.width = frame.width();
  launch(frame.backend, "bmfr-present", kernel, frame.width(), frame.height());
  PictureBuffers buffers{"bmfr-present", "bmfr-shown", "bmfr-picture", "bmfr-samples"};
  if (reflecting_.recently())
    buffers.specular = {"bmfr-specular-shown", "bmfr-specular-picture", "bmfr-specular-samples"};
  finish_picture(frame, buffers, settings_.history.newest);
}

}  // namespace relume
