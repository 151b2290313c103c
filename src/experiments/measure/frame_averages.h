// Caches frame by frame: what a frame of one sample shows on average, and how far single frames stray from that.
#pragma once

#include <string>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/estimate.h"
#include "experiments/setup/scenes.h"
#include "io/image.h"

namespace relume {

struct FramePlanOfAverages {
  int skip = 64;        ///< frames before the first that counts: cells have settled
  int count = 256;      ///< frames that count, in each repetition
  int repetitions = 6;  ///< at least three
};

struct FrameAverages {
  std::string name;
  Estimate bias2 = {};     ///< mean square difference of the average frame from the reference, without noise
  Estimate variance = {};  ///< of a frame
  double termination = 0;  ///< mean bounce at which paths cease to count; 0 without cells
  double frame_s = 0;      ///< median
  Image average = {};
};

/// Throws ExperimentStopped.
FrameAverages average_frames(const ExperimentContext& context, const ExperimentScene& scene,
                             const NamedSettings& contender, const FramePlanOfAverages& plan,
                             const Reference& reference);

}  // namespace relume
