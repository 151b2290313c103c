#include "techniques/adaptive_sampling/adaptive_sampling_pass.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "techniques/adaptive_sampling/paper_allocation.h"
#include "techniques/adaptive_sampling/pilot.h"

namespace relume {

PassDeclaration SampleCountPass::declaration() const {
  return {.name = "sequences",
          .stage = Stage::prepare,
          .owns = {{.name = kSampleCountBuffer,
                    .type = BufferType::u32,
                    .help = "samples that the pixel took from its sequence",
                    .persistent = true,
                    .display = BufferDisplay::value}}};
}

bool SampleCountPass::run(const FrameContext& frame) {
  if (frame.index.sample > 0) return true;
  const View<uint32_t> counts = frame.view<uint32_t>(kSampleCountBuffer);
  std::fill(counts.begin(), counts.end(), 0u);
  return true;
}

PassDeclaration AdaptiveSamplingPass::declaration() const {
  PassDeclaration declaration{
      .name = "allocate",
      .stage = Stage::allocate,
      .owns = {{.name = "allocation",
                .type = BufferType::u32,
                .help = "samples of this frame",
                .display = BufferDisplay::value},
               {.name = "sampling-probability",
                .help = "probability of a further sample; 0 while it is not known",
                .persistent = true,
                .reset = invalidated_by_,
                .follows_surface = true,
                .display = BufferDisplay::value},
               {.name = "sampling-noise",
                .help = "standard deviation of the samples, as the method estimates it",
                .display = BufferDisplay::value}},
      .reads = {"mean", "samples", "m2"},
      .writes = {"mean", "m2", "samples"},
      .writes_if_any = {"adaptive-m2", "light-mean", "light-m2", "light-paths", "light-frames"}};
  if (settings_.method == AdaptiveMethod::paper) {
    declaration.owns.push_back({.name = "adaptive-m2",
                                .type = BufferType::rgb32f,
                                .help = "sum of squared distances from the mean, a channel",
                                .persistent = true,
                                .reset = invalidated_by_,
                                .follows_surface = true});
  }
  return declaration;
}

bool AdaptiveSamplingPass::run(const FrameContext& frame) {
  if (settings_.method == AdaptiveMethod::paper) {
    allocate_as_paper(frame);
  } else {
    allocate_by_deviation(frame);
  }
  if (settings_.pilot && frame.since_change == static_cast<uint32_t>(settings_.max_samples)) forget_pilot(frame);
  return true;
}

void AdaptiveSamplingPass::allocate_as_paper(const FrameContext& frame) const {
  PaperAllocationKernel kernel;
  kernel.mean = frame.view<const Rgb>("mean");
  kernel.m2 = frame.view<const Rgb>("adaptive-m2");
  kernel.samples = frame.view<const uint32_t>("samples");
  kernel.probability = frame.view<float>("sampling-probability");
  kernel.noise = frame.view<float>("sampling-noise");
  kernel.allocation = frame.view<uint32_t>("allocation");
  kernel.iteration = frame.since_change;
  kernel.scene_changed = includes(frame.changes, Change::lights | Change::geometry);
  kernel.min_samples = static_cast<uint32_t>(settings_.min_samples);
  kernel.max_samples = static_cast<uint32_t>(settings_.max_samples);
  kernel.seed = frame.index.seed;
  kernel.frame = frame.number;
  kernel.width = frame.width();
  launch(frame.backend, "allocate", kernel, frame.width(), frame.height());
}

void AdaptiveSamplingPass::allocate_by_deviation(const FrameContext& frame) {
  PooledAllocationKernel kernel;
  kernel.samples = frame.view<const uint32_t>("samples");
  kernel.probability = frame.view<float>("sampling-probability");
  kernel.allocation = frame.view<uint32_t>("allocation");
  kernel.settled = settings_.pilot && frame.since_change > static_cast<uint32_t>(settings_.max_samples);
  kernel.min_samples = static_cast<uint32_t>(settings_.min_samples);
  kernel.seed = frame.index.seed;
  kernel.frame = frame.number;
  kernel.width = frame.width();
  kernel.deviation = frame.view<const float>("sampling-noise");
  if (!kernel.settled) {
    rows_.resize(frame.pixels());
    const PixelMomentsView moments{frame.view<const Rgb>("mean"), frame.view<const float>("m2"), kernel.samples,
                                   frame.width(), frame.height()};
    launch(frame.backend, "allocate", PoolRowsKernel{moments, mutable_view_of(rows_)}, frame.width(), frame.height());
    const PooledDeviationKernel deviation{moments, view_of(rows_), frame.view<float>("sampling-noise"),
                                          settings_.metric == AdaptiveMetric::display, std::exp2(settings_.exposure)};
    launch(frame.backend, "allocate", deviation, frame.width(), frame.height());
    kernel.rate = rate_for(frame, kernel.deviation);
  }
  launch(frame.backend, "allocate", kernel, frame.width(), frame.height());
}

SampleRate AdaptiveSamplingPass::rate_for(const FrameContext& frame, View<const float> deviation) {
  constexpr float kLeastShare = 0.1f;  // of the average, for pixels without noise
  constexpr int kSteps = 4;            // each comes closer to the average, which the bounds displace
  totals_.resize(frame.height());
  const auto mean_of = [&](const auto& value) {
    frame.backend.run("allocate", [&] {
      parallel_for(frame.height(), [&](size_t y) {
        const float* row = deviation.data + y * frame.width();
        totals_[y] = 0;
        for (uint32_t x = 0; x < frame.width(); ++x) totals_[y] += static_cast<double>(value(row[x]));
      });
    });
    return std::accumulate(totals_.begin(), totals_.end(), 0.0) / frame.pixels();
  };
  SampleRate rate{0.0f, kLeastShare * settings_.rate};
  const double average = mean_of([](float d) { return d; });
  if (!(average > 0)) return {0.0f, settings_.rate};  // no noise is known: all alike
  rate.scale = static_cast<float>(settings_.rate / average);
  for (int i = 1; i < kSteps; ++i) rate.scale *= static_cast<float>(settings_.rate / mean_of(rate));
  return rate;
}

void AdaptiveSamplingPass::forget_pilot(const FrameContext& frame) const {
  ForgetPilotKernel forget;
  forget.mean = frame.view<Rgb>("mean");
  forget.m2 = frame.view<float>("m2");
  forget.m2_rgb = frame.view<Rgb>("adaptive-m2");
  forget.samples = frame.view<uint32_t>("samples");
  forget.light_mean = frame.view<Rgb>("light-mean");
  forget.light_m2 = frame.view<float>("light-m2");
  forget.light_paths = frame.view<float>("light-paths");
  forget.light_frames = frame.view<uint32_t>("light-frames");
  forget.allocation = frame.view<uint32_t>("allocation");
  forget.width = frame.width();
  launch(frame.backend, "allocate", forget, frame.width(), frame.height());
}

}  // namespace relume
