#include "techniques/adaptive_sampling/adaptive_sampling_pass.h"

#include "techniques/adaptive_sampling/adaptive_sampling.h"

namespace relume {

PassDeclaration AdaptiveSamplingPass::declaration() const {
  return {.name = "allocate",
          .stage = Stage::allocate,
          .owns = {{.name = "allocation",
                    .type = BufferType::u32,
                    .help = "samples of this frame",
                    .display = BufferDisplay::value},
                   {.name = "sampling-probability",
                    .help = "probability of a further sample; 0 while it is not settled",
                    .persistent = true,
                    .reset = invalidated_by_,
                    .follows_surface = true,
                    .display = BufferDisplay::value},
                   {.name = "sampling-noise",
                    .help = "relative standard deviation of the samples",
                    .display = BufferDisplay::value},
                   {.name = "adaptive-m2",
                    .type = BufferType::rgb32f,
                    .help = "sum of squared distances from the mean, a channel",
                    .persistent = true,
                    .reset = invalidated_by_,
                    .follows_surface = true}},
          .reads = {"mean", "samples"},
          .writes = {"mean", "m2", "samples"}};
}

bool AdaptiveSamplingPass::run(const FrameContext& frame) {
  AdaptiveAllocationKernel kernel;
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
  if (!settings_.pilot || frame.since_change != kernel.max_samples) return true;
  ForgetPilotKernel forget;
  forget.mean = frame.view<Rgb>("mean");
  forget.m2 = frame.view<float>("m2");
  forget.m2_rgb = frame.view<Rgb>("adaptive-m2");
  forget.samples = frame.view<uint32_t>("samples");
  forget.allocation = frame.view<uint32_t>("allocation");
  forget.width = frame.width();
  return launch(frame.backend, "allocate", forget, frame.width(), frame.height());
}

}  // namespace relume
