#include "techniques/denoise/shared/denoiser_buffers.h"

#include "techniques/denoise/shared/converge.h"
#include "techniques/denoise/shared/image_history.h"
#include "techniques/denoise/shared/pixel_counts.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kUnfiltered{"unfiltered"};
constexpr BufferKey<float> kFilteredShare{"filtered-share"};

BufferDescription kept(const BufferId& id, const char* help) {
  return {.id = id, .help = help, .persistent = true, .display = BufferDisplay::value};
}

/// Backward reprojection by features, or by the images in reflections.
BackwardReprojection feature_reprojection(const FrameContext& frame, LightPart part) {
  return backward_reprojection(frame, part == LightPart::specular ? kReflection : kFeature);
}

/// Maximum sample count of histories in this frame.
uint32_t history_limit(const FrameContext& frame, const DenoiserHistorySettings& settings) {
  if (includes(frame.changes, Change::geometry | Change::lights))
    return static_cast<uint32_t>(settings.max_history_changed);
  return frame.changes == Change::none ? kNoHistoryLimit : static_cast<uint32_t>(settings.max_history);
}

}  // namespace

BufferDescription denoiser_history(const BufferId& id, const char* help) {
  return {.id = id,
          .help = help,
          .persistent = true,
          .double_buffered = true,
          .reset = kEndsDenoiserHistory,
          .display = BufferDisplay::value};
}

BufferDescription denoised_buffer() { return kept(kDenoised, "the denoised image"); }

BufferDescription unfiltered_buffer() {
  BufferDescription buffer = kept(kUnfiltered, "unfiltered light, such as emission: mean since the last change");
  buffer.double_buffered = true;
  return buffer;
}

BufferDescription filtered_share_buffer() {
  return kept(kFilteredShare, "fraction of the frames since the last change in which the denoiser filtered the pixel");
}

std::vector<BufferId> feature_buffers() {
  return {kRadiance,         kMean,           kMoments.m2,    kSamples,       kFeature.position,
          kFeature.previous, kFeature.normal, kFeatureAlbedo, kFeature.depth, kFeature.motion,
          kFeature.surface,  kEdgeRays,       kShownEmission, kScattered};
}

void add_split_buffers(std::vector<BufferId>& reads) {
  reads.insert(reads.end(),
               {kDiffuseAlbedo, kDiffuseScattered, kSpecularAlbedo, kSpecularScattered, kReflection.position,
                kReflection.previous, kReflection.normal, kReflection.depth, kReflection.motion});
}

void ReflectingFrames::begin_frame(const FrameContext& frame, PrimitiveScratch& scratch) {
  const View<const Rgb> albedo = frame.read(kSpecularAlbedo);
  earliest_ = before_;
  before_ = now_;
  now_ = any_of({frame.backend, "reflections", scratch}, FilteredPixels{albedo}, albedo.size);
}

void ReflectingFrames::abandon_frame() {
  now_ = before_;
  before_ = earliest_;
}

SurfaceLight surface_light(const FrameContext& frame, LightPart part) {
  constexpr BufferKey<Rgb> kPartScattered[] = {kScattered, kDiffuseScattered, kSpecularScattered, kCausticRadiance};
  constexpr BufferKey<Rgb> kPartAlbedo[] = {kFeatureAlbedo, kDiffuseAlbedo, kSpecularAlbedo, kCausticAlbedo};
  const auto i = static_cast<size_t>(part);
  SurfaceLight light{frame.read(kRadiance), frame.read(kPartScattered[i]), frame.read(kAllocation),
                     frame.read(kPartAlbedo[i]), frame.read(kShownEmission)};
  if (part != LightPart::caustics) light.caustics = frame.read(kFilteredCaustics);
  return light;
}

LightHistory light_history(const FrameContext& frame, const LightHistoryBuffers& buffers,
                           const DenoiserHistorySettings& settings, LightPart part) {
  return {.reprojection = feature_reprojection(frame, part),
          .samples = surface_light(frame, part),
          .light_before = frame.previous(buffers.light),
          .count_before = frame.previous(buffers.samples),
          .light = frame.write(buffers.light),
          .count = frame.write(buffers.samples),
          .max_samples = history_limit(frame, settings),
          .least_share = 0,
          .discounts = {}};
}

bool lacks_history(const FrameContext& frame, PrimitiveScratch& scratch, const BufferKey<uint32_t>& samples,
                   const BufferKey<uint32_t>& specular_samples) {
  if (frame.number > 0 && frame.changes == Change::none) return false;
  FreshPixels pixels;
  pixels.albedo = frame.read(kFeatureAlbedo);
  pixels.samples = frame.read(samples);
  pixels.specular_samples = specular_samples.name.empty() ? pixels.samples : frame.read(specular_samples);
  // While upscaling, pixels may have one sample for several frames.
  pixels.max_fresh_samples = frame.turns > 1 ? 0 : 1;
  const FreshCount count =
      reduce<AddFreshCounts>({frame.backend, "fresh-pixels", scratch}, pixels, FreshPixels::count(frame.pixels()));
  return 2 * count.fresh > count.filtered;
}

bool finish_image(const FrameContext& frame, PrimitiveScratch& scratch, const ImageBuffers& buffers, float newest) {
  const bool still = frame.changes == Change::none;
  ImageHistoryKernel average;
  average.shown = frame.read(buffers.shown);
  average.before = frame.previous(buffers.history);
  average.motion = frame.read(kFeature.motion);
  average.albedo = frame.read(kFeatureAlbedo);
  average.emission = frame.read(kShownEmission);
  average.edge_rays = frame.read(kEdgeRays);
  average.unfiltered_before = frame.previous(kUnfiltered);
  average.unfiltered = frame.write(kUnfiltered);
  average.filtered_share = frame.write(kFilteredShare);
  average.image = frame.write(buffers.history);
  if (!buffers.specular.shown.name.empty()) {
    average.specular.shown = frame.read(buffers.specular.shown);
    average.specular.before = frame.previous(buffers.specular.history);
    average.specular.motion = frame.read(kReflection.motion);
    average.specular.image = frame.write(buffers.specular.history);
  }
  // A count of one may also mean that light has changed, or that the pixel got no sample in this frame.
  const bool light_changes = includes(frame.changes, Change::geometry | Change::lights);
  if (!light_changes && frame.read(kAllocation).empty()) {
    average.samples = frame.read(buffers.samples);
    if (!buffers.specular.samples.name.empty()) average.specular.samples = frame.read(buffers.specular.samples);
  }
  average.still = still;
  average.newest = newest;
  average.frames = frame.since_change + 1;
  // With upscaling, the average begins with the first image in which all pixels have samples.
  average.averaged = average.frames - (average.frames < frame.turns ? 0 : frame.turns - 1);
  const bool changed = includes(frame.changes, Change::materials | Change::settings);
  if (frame.number == 0 || changed || lacks_history(frame, scratch, buffers.samples, buffers.specular.samples))
    average.newest = 1.0f;
  average.width = frame.width();
  average.height = frame.height();
  if (!frame.launch_or_stop(buffers.launch_name, average)) return false;

  ConvergeKernel converge;
  converge.image = frame.read(buffers.history);
  converge.mean = frame.read(kMean);
  converge.m2 = frame.read(kMoments.m2);
  converge.samples = frame.read(kSamples);
  converge.converged = frame.write(kDenoised);
  converge.stratified = frame.stratified;
  converge.correlated_frames = static_cast<float>(frame.correlated_frames);
  converge.still = still;
  converge.width = frame.width();
  converge.height = frame.height();
  return frame.launch_or_stop(buffers.launch_name, converge);
}

}  // namespace relume
