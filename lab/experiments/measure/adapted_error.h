// Measures the error of single frames of adapted techniques, by image region.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
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

/// Contenders alternate frame by frame. Those that keep state between frames render several sessions with different
/// seeds, in sequence.
struct AdaptedOptions {
  int warm_up = 128;  ///< unmeasured frames at the start of each session
  int frames = 64;    ///< measured frames per session
  int sessions = 4;
  /// Frames averaged to one value: adaptive techniques correlate successive frames, so single frames would
  /// underestimate the error of the mean. Divides `frames`. For randomly prepared techniques and for reservoirs of
  /// earlier frames, a whole session is one value.
  int block = 32;
  int seed = 1;  ///< seed of the first session
};

struct AdaptedError {
  std::string name;
  std::vector<std::vector<double>> mse;                ///< by region, by block of frames; without the reference's noise
  std::vector<double> frame_s;                         ///< time of each measured frame, in seconds
  double rays = 0;                                     ///< per pixel and measured frame
  std::vector<std::pair<std::string, double>> pass_s;  ///< by pass: mean seconds per measured frame
  std::vector<PassStatistic> figures;                  ///< after the last frame
  Image last;                                          ///< the last frame

  double mean_mse(size_t region = 0) const { return mean(mse[region]); }
  double median_s() const { return median(frame_s); }
};
constexpr auto members_of(const PassStatistic*) { return std::tuple(&PassStatistic::name, &PassStatistic::value); }
constexpr auto members_of(const AdaptedError*) {
  return std::tuple(&AdaptedError::name, &AdaptedError::mse, &AdaptedError::frame_s, &AdaptedError::rays,
                    &AdaptedError::pass_s, &AdaptedError::figures, &AdaptedError::last);
}

/// Renders every contender from scratch, without a history. Contenders take turns frame by frame, so that disturbances
/// affect all equally. Techniques that neither learn nor reuse samples skip warm-up, except one frame for their
/// preparation. If the preparation is not random, a single session is rendered. The first rank measures. Results of an
/// interrupted experiment are reused. Throws ExperimentStopped.
std::vector<AdaptedError> measure_adapted(const ExperimentContext& context, const ExperimentScene& scene,
                                          const std::vector<NamedSettings>& contenders, const Reference& reference,
                                          const std::vector<PixelMask>& regions, const AdaptedOptions& options);

/// Ratio of a's frame time to b's: the median over pairs of frames rendered in turn.
Ratio time_ratio(const AdaptedError& a, const AdaptedError& b);
/// Ratio of MSE times frame time, a over b: the result at equal time if errors fall with 1 / time, as for independent
/// frames.
Ratio equal_time_ratio(const AdaptedError& a, const AdaptedError& b, size_t region = 0);

/// Reference and last frame of each contender.
ImageSet adapted_images(const std::string& label, const std::vector<AdaptedError>& errors, const Image& reference);

/// 128 warm-up frames and 64 measured ones in four sessions; fewer in a quick run. Images of a larger `scale`
/// (ExperimentScene) have fewer frames, because techniques learn from more samples in each.
AdaptedOptions adapted_options(const ExperimentContext& context, int scale = 1);
/// Protocol of experiments with measure_adapted() and adapted_options().
std::vector<std::pair<std::string, std::string>> adapted_setup(const ExperimentContext& context);

}  // namespace relume
