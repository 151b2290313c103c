#include "techniques/temporal/adaptive_sampling/adaptive_sampling_pass.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "frame/moments.h"
#include "frame/primitives/fill.h"
#include "techniques/temporal/adaptive_sampling/paper_allocation.h"

namespace relume {
namespace {

constexpr BufferKey<float> kSamplingNoise{"sampling-noise"};

constexpr float kLeastShare = 0.1f;  ///< least rate of a pixel without noise, as a fraction of the mean rate

}  // namespace

PassDeclaration SampleCountPass::declaration() const {
  return {.name = "sequences",
          .stage = Stage::prepare,
          .owns = {{.id = kSequenceSamples,
                    .help = "number of samples that the pixel took from its sequence",
                    .persistent = true,
                    .display = BufferDisplay::value}}};
}

bool SampleCountPass::run(const FrameContext& frame) {
  if (frame.index.sample > 0) return true;
  const View<uint32_t> counts = frame.write(kSequenceSamples);
  fill(frame.backend, "sequences", counts, 0u);
  return true;
}

PassDeclaration AdaptiveSamplingPass::declaration() const {
  return {.name = "allocate",
          .stage = Stage::allocate,
          .owns = {{.id = kAllocation, .help = "number of samples in this frame", .display = BufferDisplay::value},
                   {.id = kSamplingProbability,
                    .help = "probability of a further sample; 0 while it is unknown",
                    .persistent = true,
                    .reset = invalidated_by_,
                    .follows_surface = true,
                    .display = BufferDisplay::value},
                   {.id = kSamplingNoise,
                    .help = "standard deviation of the samples, as estimated by adaptive.method",
                    .persistent = true,
                    .display = BufferDisplay::value}},
          .reads = {kMean, kMoments.m2, kMoments.m2_rgb, kSamples},
          .reads_if_any = moment_ids(kInherited)};
}

bool AdaptiveSamplingPass::run(const FrameContext& frame) {
  if (settings_.method == AdaptiveMethod::paper) {
    allocate_as_paper(frame);
  } else {
    allocate_by_deviation(frame);
  }
  if (frame.ends_pilot) {
    // The image starts again with this frame: every pixel needs a sample.
    fill(frame.backend, "allocate", frame.write(kAllocation), 1u);
  }
  return true;
}

void AdaptiveSamplingPass::allocate_as_paper(const FrameContext& frame) const {
  PaperAllocationKernel kernel;
  kernel.history = read_history(frame);
  kernel.probability = frame.write(kSamplingProbability);
  kernel.noise = frame.write(kSamplingNoise);
  kernel.allocation = frame.write(kAllocation);
  kernel.iteration = frame.since_change;
  kernel.scene_changed = includes(frame.changes, Change::lights | Change::geometry);
  kernel.min_samples = static_cast<uint32_t>(settings_.min_samples);
  kernel.max_samples = static_cast<uint32_t>(settings_.max_samples);
  kernel.seed = frame.index.seed;
  kernel.frame = frame.number;
  kernel.width = frame.width();
  frame.launch("allocate", kernel);
}

bool AdaptiveSamplingPass::estimates_in(const FrameContext& frame) const {
  if (settings_.pilot && frame.since_change > static_cast<uint32_t>(settings_.max_samples)) return false;
  if (frame.since_change <= static_cast<uint32_t>(settings_.min_samples)) return true;
  const float frames_per_sample = std::round(1.0f / settings_.rate);
  return frame.since_change % static_cast<uint32_t>(frames_per_sample) == 0;
}

void AdaptiveSamplingPass::estimate_deviation(const FrameContext& frame) {
  // Zero outside of the rendered pixels, where pools reach.
  for (Array<PooledMoments>* moments : {&moments_, &rows_})
    if (moments->size() != frame.pixels()) resize(frame.backend, "allocate", *moments, frame.pixels());
  const OwnStatisticsKernel own{read_history(frame), moments_.mutable_view(), frame.width()};
  frame.launch("allocate", own);
  const PoolRowsKernel rows{moments_.view(), rows_.mutable_view(), frame.width()};
  frame.launch("allocate", rows);
  const PooledDeviationKernel deviation{.moments = moments_.view(),
                                        .rows = rows_.view(),
                                        .deviation = frame.write(kSamplingNoise),
                                        .width = frame.width(),
                                        .height = frame.height(),
                                        .display = settings_.metric == AdaptiveMetric::display,
                                        .exposure = math::exp2(settings_.exposure)};
  frame.launch("allocate", deviation);
}

void AdaptiveSamplingPass::allocate_by_deviation(const FrameContext& frame) {
  PooledAllocationKernel kernel;
  kernel.samples = read_history(frame).samples;
  kernel.probability = frame.write(kSamplingProbability);
  kernel.allocation = frame.write(kAllocation);
  kernel.settled = !estimates_in(frame);
  kernel.min_samples = static_cast<uint32_t>(settings_.min_samples);
  kernel.seed = frame.index.seed;
  kernel.frame = frame.number;
  kernel.width = frame.width();
  kernel.deviation = frame.read(kSamplingNoise);
  if (!kernel.settled) {
    estimate_deviation(frame);
    kernel.rate = rate_for(frame, kernel.deviation);
  }
  frame.launch("allocate", kernel);
}

RateSums AdaptiveSamplingPass::means_of(const FrameContext& frame, View<const float> deviation,
                                        const SampleRate& rate) {
  const PrimitiveLaunch at{frame.backend, "allocate", scratch_};
  const RateSums sum = reduce<AddRates>(at, PixelRates{deviation, rate}, deviation.size);
  const double pixels = frame.pixels();
  return {sum.deviation / pixels, sum.probability / pixels, sum.cut / pixels};
}

SampleRate AdaptiveSamplingPass::rate_for(const FrameContext& frame, View<const float> deviation) {
  const double average = means_of(frame, deviation, {}).deviation;
  if (!(average > 0)) return {0.0f, 1.0f};  // no noise measured: sample every pixel
  const SampleRate rate = rate_that_cuts_little(frame, deviation, average);
  return rate.least >= kLeastShare * settings_.rate ? rate : rate_of_average(frame, deviation, average);
}

SampleRate AdaptiveSamplingPass::rate_that_cuts_little(const FrameContext& frame, View<const float> deviation,
                                                       double average) {
  constexpr double kKept = 0.95;
  constexpr int kSteps = 6;  // Newton steps, which descend to the solution: the mean of min(s σ, 1) is concave in s
  double scale = 1 / (kKept * average);
  for (int i = 0; i < kSteps; ++i) {
    const SampleRate rate{static_cast<float>(scale), 0.0f};
    const RateSums mean = means_of(frame, deviation, rate);
    const double within = mean.probability - mean.cut;
    if (mean.cut == 0) break;
    scale = mean.cut / (kKept * average - within / scale);
  }
  return {static_cast<float>(scale), static_cast<float>(kLeastShare * kKept * scale * average)};
}

SampleRate AdaptiveSamplingPass::rate_of_average(const FrameContext& frame, View<const float> deviation,
                                                 double average) {
  constexpr int kSteps = 4;  // each approaches the rate, which the bounds displace
  SampleRate rate{static_cast<float>(settings_.rate / average), kLeastShare * settings_.rate};
  for (int i = 1; i < kSteps; ++i)
    rate.scale *= static_cast<float>(settings_.rate / means_of(frame, deviation, rate).probability);
  return rate;
}

}  // namespace relume
