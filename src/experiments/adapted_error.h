// The error of single frames once techniques have adapted, region by region of the picture.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/scenes.h"
#include "io/image.h"
#include "metrics/statistics.h"
#include "render/session.h"
#include "report/page.h"

namespace relume {

/// A part of the picture.
struct PictureRegion {
  std::string name;
  std::vector<uint8_t> mask;  ///< by pixel, row by row; 0: outside

  size_t pixels() const;
};

/// All pixels of a picture of that size.
PictureRegion whole_picture(int width, int height);

/// MSE of one frame in one region: mean over its pixels and over R, G and B of (frame − reference)².
double frame_mse(const Image& frame, const Image& reference, const PictureRegion& region);

/// What the reference's own noise adds to frame_mse(), by its estimate; 0 if that is not known.
double reference_noise(const Reference& reference, const PictureRegion& region);

struct AdaptedContender {
  std::string name;
  RenderSettings settings;
};

struct AdaptedOptions {
  int warm_up = 128;  ///< frames that are not measured
  int frames = 256;
  int seed = 1;
};

struct AdaptedError {
  std::string name;
  std::vector<std::vector<double>> mse;                ///< by region, by measured frame; without the reference's noise
  std::vector<double> frame_s;                         ///< seconds of each measured frame
  std::vector<std::pair<std::string, double>> pass_s;  ///< by pass: mean of the measured frames
  std::vector<PassFigure> figures;                     ///< after the last frame
  Image last;                                          ///< the last frame

  double mean_mse(size_t region = 0) const { return mean(mse[region]); }
  double median_s() const { return median(frame_s); }
};

/// Renders every contender from the start, without a history; contenders take turns frame by frame, so that whatever
/// disturbs the machine disturbs all alike. Throws ExperimentStopped.
std::vector<AdaptedError> measure_adapted(const ExperimentContext& context, const ExperimentScene& scene,
                                          const std::vector<AdaptedContender>& contenders, const Reference& reference,
                                          const std::vector<PictureRegion>& regions, const AdaptedOptions& options);

/// A quotient with a 95 % interval from the spread of the frames (delta method).
struct ErrorRatio {
  double value = 0;
  Interval interval;
};
/// a's mean over b's: how many times lower b's error is.
ErrorRatio error_ratio(const std::vector<double>& a, const std::vector<double>& b);
/// The same at equal time: each error times the median time of its contender's frames.
ErrorRatio equal_time_ratio(const AdaptedError& a, const AdaptedError& b, size_t region = 0);

/// "10.3× (9.8 to 10.9)".
std::string to_text(const ErrorRatio& ratio);

/// The reference and the last frame of each.
PictureSet adapted_pictures(const std::string& label, const std::vector<AdaptedError>& errors, const Image& reference);

/// What such experiments say of their protocol.
std::vector<std::pair<std::string, std::string>> adapted_setup(const ExperimentContext& context);

}  // namespace relume
