// Caches frame by frame: what a frame of one sample shows on average, and how far single frames stray from that.
#pragma once

#include <string>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/estimate.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

struct FramePlanOfAverages {
  int skip = 64;        ///< frames before the first that counts: cells have settled
  int count = 256;      ///< frames that count, in each repetition
  int repetitions = 6;  ///< at least three
};

/// Sums over the frames of a repetition.
struct FrameSums {
  std::vector<glm::dvec3> values;  ///< by pixel
  std::vector<double> squares;     ///< by pixel, of all channels
  int count = 0;

  void add(const Image& image);
};

/// Variance of a frame, mean over the region's pixels and channels: the mean square less the square of the mean, by
/// products of different repetitions. Frames of one repetition share what cells remember; their spread about their own
/// mean would be too small. Requires three repetitions.
Estimate frame_variance(const std::vector<FrameSums>& repetitions, const PixelMask& region);

struct FrameAverages {
  std::string name;
  Estimate bias2 = {};             ///< mean square difference of the average frame from the reference, without noise
  Estimate variance = {};          ///< of a frame, over independent sessions
  Estimate surface_variance = {};  ///< the same over the pixels of `surfaces`
  Estimate termination = {};       ///< mean bounce at which paths cease to count; 0 without cells
  Image average = {};
};

/// Throws ExperimentStopped.
FrameAverages average_frames(const ExperimentContext& context, const ExperimentScene& scene,
                             const NamedSettings& contender, const FramePlanOfAverages& plan,
                             const Reference& reference, const PixelMask& surfaces);

}  // namespace relume
