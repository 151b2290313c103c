// Direct light at primary hits by resampled importance sampling, without reuse between pixels or frames.
#pragma once

#include "techniques/reuse/reservoir/candidate_stage.h"

namespace relume {

/// Purposes of ChoiceNumbers.
inline constexpr uint32_t kChoosesCandidates = 0x52495301u;
inline constexpr uint32_t kChoosesNeighbours = 0x52495302u;

/// Adds the direct light of each pixel that has a path.
struct RisKernel {
  CandidateStage stage;
  ReservoirImage image;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * stage.width + x;
    if (!image.planes.sampled.has(pixel)) return;
    Sampler sampler = stage.index.sampler(x, y);
    ReceiverRecord record;
    Receiver r;
    if (!stage.receive(x, y, sampler, record, r)) return;
    ChoiceNumbers numbers(stage.index.seed, stage.index.frame, pixel, kChoosesCandidates);
    const LightReservoir own = stage.choose(pixel, r, sampler, numbers, image.planes.rays[pixel]);
    image.add(stage.context.scene, r, own, pixel);
  }
};

}  // namespace relume
