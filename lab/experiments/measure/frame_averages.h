// Measures the average of one-sample frames with caches, and the deviation of single frames from it.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/estimate.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

struct FramePlanOfAverages {
  int skip = 64;        ///< frames before counting starts, for cells to settle
  int count = 256;      ///< counted frames per repetition
  int repetitions = 6;  ///< at least three
};

/// Sums over the frames of a repetition.
struct FrameSums {
  std::vector<glm::dvec3> values;  ///< per pixel
  std::vector<double> squares;     ///< per pixel, over all channels
  int count = 0;

  void add(const Image& image);
};
constexpr auto members_of(const FrameSums*) {
  return std::tuple(&FrameSums::values, &FrameSums::squares, &FrameSums::count);
}

/// Variance of a frame, averaged over the region's pixels and channels: mean square minus square of the mean. The
/// latter uses products of different repetitions. Frames of one repetition share cell contents, so their spread about
/// their own mean would underestimate the variance. Requires three repetitions.
Estimate frame_variance(const std::vector<FrameSums>& repetitions, const PixelMask& region);

struct FrameAverages {
  std::string name;
  Estimate bias2 = {};             ///< mean squared difference between average frame and reference, without noise
  Estimate variance = {};          ///< variance of a frame over independent sessions
  Estimate surface_variance = {};  ///< same, over the pixels of `surfaces`
  Estimate termination = {};       ///< mean bounce at which cells terminate paths; 0 without cells
  std::vector<double> light = {};  ///< per repetition: mean of its average over pixels and channels
  Image average = {};
};

/// Measures one contender. Throws ExperimentStopped.
FrameAverages average_frames(const ExperimentContext& context, const ExperimentScene& scene,
                             const NamedSettings& contender, const FramePlanOfAverages& plan,
                             const Reference& reference, const PixelMask& surfaces);

}  // namespace relume
