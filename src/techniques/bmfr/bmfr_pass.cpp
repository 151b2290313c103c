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

}  // namespace

PassDeclaration BmfrPass::declaration() const {
  const auto scratch = [](const char* name, BufferType type, const char* help) {
    return BufferDescription{.name = name, .type = type, .help = help};
  };
  return {.name = "bmfr",
          .stage = Stage::denoise,
          .owns = {denoiser_history("bmfr-light", BufferType::rgb32f, "light at the surface, as far as samples tell"),
                   denoiser_history("bmfr-square", BufferType::f32, "mean square of the luminance of its samples"),
                   denoiser_history("bmfr-samples", BufferType::u32, "samples in it"),
                   denoiser_history("bmfr-fit", BufferType::rgb32f, "light as features explain it"),
                   denoiser_history("bmfr-picture", BufferType::rgb32f, "filtered pictures, averaged"),
                   denoised_buffer(), unfiltered_buffer(), filtered_share_buffer(),
                   scratch("bmfr-fit-history", BufferType::rgb32f, "bmfr-fit of the frame before, where it was"),
                   scratch("bmfr-shown", BufferType::rgb32f, "this frame's picture"),
                   scratch("bmfr-age", BufferType::u32, "samples in that history")},
          .reads = feature_buffers(),
          .reads_if_any = {"allocation"}};
}

bool BmfrPass::run(const FrameContext& frame) {
  accumulate(frame);
  fit(frame);
  present(frame);
  return true;
}

// None of these is to be stopped: the frame's samples have joined the mean by now.

void BmfrPass::accumulate(const FrameContext& frame) {
  BmfrAccumulateKernel kernel;
  kernel.history = light_history(frame, {"bmfr-light", "bmfr-samples"}, settings_.history);
  kernel.history.least_share = settings_.alpha;
  kernel.history.discounts = change_.discounts(frame, kernel.history);
  kernel.fitted_before = frame.previous<const Rgb>("bmfr-fit");
  kernel.square_before = frame.previous<const float>("bmfr-square");
  kernel.fitted_history = frame.view<Rgb>("bmfr-fit-history");
  kernel.square = frame.view<float>("bmfr-square");
  kernel.age = frame.view<uint32_t>("bmfr-age");
  launch(frame.backend, "bmfr-accumulate", kernel, frame.width(), frame.height());
}

void BmfrPass::fit(const FrameContext& frame) {
  noise_.resize(kBlockNoise);
  const BlockNoiseKernel noise{mutable_view_of(noise_), frame.number};
  launch(frame.backend, "bmfr-fit", noise, kBlockPixels, kBlockFeatures - 1);
  BlockRegressionKernel kernel;
  kernel.position = frame.view<const Vec3>("feature-position");
  kernel.normal = frame.view<const Vec3>("feature-normal");
  kernel.albedo = frame.view<const Rgb>("feature-albedo");
  kernel.light = frame.view<const Rgb>("bmfr-light");
  kernel.samples = frame.view<const uint32_t>("bmfr-samples");
  kernel.square = frame.view<const float>("bmfr-square");
  kernel.noise = view_of(noise_);
  kernel.fitted = frame.view<Rgb>("bmfr-fit");
  kernel.noise_scale = settings_.noise;
  kernel.detail = settings_.detail;
  kernel.most_samples = independent_samples(settings_.alpha);
  kernel.width = frame.width();
  kernel.height = frame.height();
  // Without fits of earlier frames the edges of blocks would show.
  uint32_t fits = 1;
  if (includes(frame.changes, Change::geometry | Change::lights)) fits = kFitsOfChangedLight;
  if (begins_anew(frame, "bmfr-samples")) fits = kFirstFits;
  for (uint32_t i = 0; i < fits; ++i) {
    kernel.shift_x = shift_of(frame.number + i, 2);
    kernel.shift_y = shift_of(frame.number + i, 3);
    kernel.share = 1.0f / static_cast<float>(i + 1);
    launch(frame.backend, "bmfr-fit", kernel, BlockRegressionKernel::blocks(frame.width()),
           BlockRegressionKernel::blocks(frame.height()), {}, 1);
  }
}

void BmfrPass::present(const FrameContext& frame) const {
  BmfrPresentKernel kernel;
  kernel.samples = surface_light(frame);
  kernel.age = frame.view<const uint32_t>("bmfr-age");
  kernel.fitted_history = frame.view<const Rgb>("bmfr-fit-history");
  kernel.fitted = frame.view<Rgb>("bmfr-fit");
  kernel.shown = frame.view<Rgb>("bmfr-shown");
  kernel.max_fits = static_cast<uint32_t>(settings_.max_fits);
  kernel.width = frame.width();
  launch(frame.backend, "bmfr-present", kernel, frame.width(), frame.height());
  finish_picture(frame, {"bmfr-present", "bmfr-shown", "bmfr-picture", "bmfr-samples"}, settings_.history.newest);
}

}  // namespace relume
