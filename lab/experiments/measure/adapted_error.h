// The error of single frames once techniques have adapted, region by region of the image.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/scenes.h"
#include "metrics/statistics.h"
#include "relume/image_io.h"
#include "render/session.h"
#include "report/page.h"

namespace relume {

/// Several sessions with seeds of their own, one after the other.
struct AdaptedOptions {
  int warm_up = 128;  ///< frames in which a session adapts, before those that are measured
  int frames = 64;    ///< measured in each session
  int sessions = 4;
  /// Frames whose mean counts as one value: what a frame has learned goes into the next, so that single ones do not
  /// tell how far the mean is off. Divides `frames`. Of what is prepared by chance a whole session is one value.
  int block = 32;
  int seed = 1;  ///< of the first session
};

struct AdaptedError {
  std::string name;
  std::vector<std::vector<double>> mse;                ///< by region, by block of frames; without the reference's noise
  std::vector<double> frame_s;                         ///< seconds of each measured frame
  std::vector<std::pair<std::string, double>> pass_s;  ///< by pass: mean of the measured frames
  std::vector<PassStatistic> figures;                  ///< after the last frame
  Image last;                                          ///< the last frame

  double mean_mse(size_t region = 0) const { return mean(mse[region]); }
  double median_s() const { return median(frame_s); }
};

/// Renders every contender from the start, without a history; contenders take turns frame by frame, so that whatever
/// disturbs the machine disturbs all alike. What learns nothing from frames has no need to adapt, but for one frame for
/// what it prepares; and if chance has no part in that either, a single session is rendered. What an interrupted
/// experiment has measured is not measured again. Throws ExperimentStopped.
std::vector<AdaptedError> measure_adapted(const ExperimentContext& context, const ExperimentScene& scene,
                                          const std::vector<NamedSettings>& contenders, const Reference& reference,
                                          const std::vector<PixelMask>& regions, const AdaptedOptions& options);

/// Median over the turns of a's time of a frame over b's.
Ratio time_ratio(const AdaptedError& a, const AdaptedError& b);
/// MSE times the time of a frame, a's over b's: what equal time would give if errors fell with 1 / time, as
/// those of independent frames do.
Ratio equal_time_ratio(const AdaptedError& a, const AdaptedError& b, size_t region = 0);

/// The reference and the last frame of each.
ImageSet adapted_images(const std::string& label, const std::vector<AdaptedError>& errors, const Image& reference);

/// 128 frames to adapt and four times 64 measured; few in a quick run.
AdaptedOptions adapted_options(const ExperimentContext& context);
/// What experiments with measure_adapted() and adapted_options() say of their protocol.
std::vector<std::pair<std::string, std::string>> adapted_setup(const ExperimentContext& context);

}  // namespace relume
