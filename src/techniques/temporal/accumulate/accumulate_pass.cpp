#include "techniques/temporal/accumulate/accumulate_pass.h"

#include <cmath>
#include <limits>

#include "frame/moments.h"
#include "techniques/temporal/accumulate/accumulate.h"

namespace relume {
namespace {

constexpr BufferKey<uint32_t> kHeatmap{"heatmap"};

void add_splat_image(PassDeclaration& declaration, Change reset) {
  const auto add = [&](const BufferId& id, const char* help) {
    declaration.owns.push_back({.id = id, .help = help, .persistent = true, .reset = reset, .follows_surface = true});
  };
  add(kLightMean, "mean radiance of light paths");
  add(kLightM2, "weighted sum of squared luminance deviations of light paths from light-mean");
  add(kLightPaths, "light paths per pixel in light-mean");
  add(kLightFrames, "number of frames in light-mean");
  declaration.reads.push_back(kLightRadiance);
}

void add_specular_part(PassDeclaration& declaration, Change reset) {
  const auto add = [&](const BufferId& id, const char* help) {
    declaration.owns.push_back(
        {.id = id, .help = help, .persistent = true, .reset = reset, .display = BufferDisplay::value});
  };
  add(kSpecularMean, "specular part of mean");
  add(kSpecularSamples, "number of samples in specular-mean");
  declaration.reads.insert(declaration.reads.end(),
                           {kRadianceSpecular, kSpecularAlbedo, kInheritedSpecularMean, kInheritedSpecularSamples});
}

void add_caustic_layer(PassDeclaration& declaration, Change reset) {
  const auto add = [&](const BufferId& id, const char* help, BufferDisplay display = BufferDisplay::hidden) {
    declaration.owns.push_back(
        {.id = id, .help = help, .persistent = true, .reset = reset, .follows_surface = true, .display = display});
  };
  add(kCausticMoments.mean,
      "caustic layer, a part of mean: light paths connected to the camera, and merged light behind specular surfaces",
      BufferDisplay::value);
  add(kCausticMoments.m2, "sum of squared luminance deviations of the samples from caustics");
  add(kCausticMoments.samples, "number of samples in caustics");
  declaration.reads.push_back(kCausticRadiance);
}

void add_cells_part(PassDeclaration& declaration, Change reset) {
  declaration.owns.push_back({.id = kCellsMean, .help = "part of mean from cells", .persistent = true, .reset = reset});
  declaration.owns.push_back(
      {.id = kCellsSamples, .help = "number of samples in cells-mean", .persistent = true, .reset = reset});
  declaration.reads.insert(declaration.reads.end(), {kRadianceCells, kInheritedCellsMean, kInheritedCellsSamples});
}

SplatImage splat_image_of(const FrameContext& frame, PrimitiveScratch& scratch) {
  const uint64_t traced = sum({frame.backend, "accumulate", scratch}, frame.read(kAllocation));
  return {.splats = frame.read(kLightRadiance),
          .mean = frame.write(kLightMean),
          .m2 = frame.write(kLightM2),
          .weight = frame.write(kLightPaths),
          .frames = frame.write(kLightFrames),
          .paths = static_cast<float>(traced) / static_cast<float>(frame.pixels())};
}

CausticMoments caustic_moments(const FrameContext& frame) {
  return {.radiance = frame.read(kCausticRadiance),
          .moments = {.mean = frame.write(kCausticMoments.mean),
                      .m2 = frame.write(kCausticMoments.m2),
                      .m2_rgb = {},
                      .samples = frame.write(kCausticMoments.samples)}};
}

SpecularMean specular_mean(const FrameContext& frame) {
  return {.radiance = frame.read(kRadianceSpecular),
          .albedo = frame.read(kSpecularAlbedo),
          .history = frame.read(kInheritedSpecularMean),
          .history_samples = frame.read(kInheritedSpecularSamples),
          .mean = frame.write(kSpecularMean),
          .samples = frame.write(kSpecularSamples)};
}

SpecularMean cells_mean(const FrameContext& frame) {
  return {.radiance = frame.read(kRadianceCells),
          .albedo = {},
          .history = frame.read(kInheritedCellsMean),
          .history_samples = frame.read(kInheritedCellsSamples),
          .mean = frame.write(kCellsMean),
          .samples = frame.write(kCellsSamples)};
}

}  // namespace

PassDeclaration AccumulatePass::declaration() const {
  const auto kept = [&](const BufferId& id, const char* help, BufferDisplay display = BufferDisplay::hidden) {
    return BufferDescription{.id = id, .help = help, .persistent = true, .reset = invalidated_by_, .display = display};
  };
  PassDeclaration declaration{
      .name = "accumulate",
      .stage = Stage::present,
      .owns = {kept(kMean, "mean radiance of the pixel's samples"),
               kept(kMoments.m2, "sum of squared luminance deviations of the samples from mean"),
               kept(kSamples, "number of samples in mean", BufferDisplay::value),
               {.id = kHeatmap,
                .help = "rays traced for the pixel per frame",
                .persistent = true,
                .reset = Change::any,
                .display = BufferDisplay::mean},
               {.id = kNonfinite,
                .help = "number of samples that were not finite",
                .persistent = true,
                .display = BufferDisplay::value}},
      .reads = {kRadiance, kRays},
      .reads_if_any = moment_ids(kInherited),
      .writes_if_any = {kMoments.m2_rgb, kSequenceSamples}};
  declaration.reads_if_any.push_back(kAllocation);
  if (parts_.m2_rgb)
    declaration.owns.push_back(kept(kMoments.m2_rgb, "sum of squared deviations of all channels from mean"));
  if (parts_.splat_image) add_splat_image(declaration, invalidated_by_);
  if (parts_.specular) add_specular_part(declaration, invalidated_by_);
  if (parts_.caustics) add_caustic_layer(declaration, invalidated_by_);
  if (parts_.cells) add_cells_part(declaration, invalidated_by_);
  return declaration;
}

bool AccumulatePass::run(const FrameContext& frame) {
  AccumulateKernel kernel;
  kernel.radiance = frame.read(kRadiance);
  kernel.rays = frame.read(kRays);
  kernel.allocation = frame.read(kAllocation);
  kernel.moments = write_moments(frame, kMoments);
  const MomentsView inherited = read_moments(frame, kInherited);
  kernel.history = inherited.mean.empty() ? kernel.moments : inherited;
  kernel.taken = frame.write(kSequenceSamples);
  kernel.ray_sum = frame.write(kHeatmap);
  kernel.nonfinite = frame.write(kNonfinite);
  if (parts_.splat_image) kernel.splat_image = splat_image_of(frame, scratch_);
  if (parts_.specular) kernel.specular = specular_mean(frame);
  if (parts_.caustics) kernel.caustics = caustic_moments(frame);
  if (parts_.cells) kernel.specular = cells_mean(frame);
  kernel.keep = keep_ && !frame.ends_pilot;
  kernel.width = frame.width();
  // Cannot be cancelled: sums must change only in complete frames.
  frame.launch("accumulate", kernel);
  return true;
}

double relative_error(const PrimitiveLaunch& at, const ImageErrors& image) {
  const ImageErrorSums sums = reduce<AddImageErrors>(at, image, image.pixels());
  if (sums.undersampled > 0) return std::numeric_limits<double>::infinity();
  if (sums.luminance <= 0) return 0;
  return std::sqrt(sums.variance / image.pixels()) / (sums.luminance / image.pixels());
}

}  // namespace relume
