// Error against frames while techniques adapt, averaged over independent runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/measure/adapted_error.h"
#include "report/page.h"

namespace relume {

/// The MSE of each frame of each run.
struct Adaptation {
  std::string name;
  std::vector<std::vector<double>> runs;  ///< by run, by frame, without the reference's noise; all of the same length

  /// Each run's MSE of that frame, and its mean over the last `frames` frames.
  std::vector<double> at(size_t frame) const;
  std::vector<double> plateaus(size_t frames) const;
  double plateau(size_t frames) const { return mean(plateaus(frames)); }
  /// The mean of `count` frames from `begin` on over that of the last quarter, run by run; 1: it has adapted by then.
  Ratio over_plateau(size_t begin, size_t count) const;
};

/// Runs a session `runs` times with different seeds; `before` is called with the number of the frame before each of
/// `frames` frames. `region`: of the image, in which errors count. Throws ExperimentStopped.
Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PixelMask& region,
                              const std::function<void(Session&, int frame)>& before = {});

/// Frames whose mean tells whether a technique has adapted: what single ones show is mostly noise.
inline constexpr size_t kFramesThatTell = 8;

/// "1.8 (1.7 to 1.9) in the first frame, 1.02 (0.99 to 1.05) in frames 11 to 18": of the plateau, by frames counted
/// from 1.
std::string adaptation_text(const Adaptation& adaptation, size_t adapted);

/// A claim that frames from number `adapted` on, counted from 1, are within 10 % of the plateau.
Claim judged_adapted(std::string id, std::string paper, std::string claim, const Adaptation& adaptation,
                     size_t adapted);

/// Curves of MSE against frames, the first of which is number `first_frame`.
ChartBlock adaptation_chart(std::string title, std::string text, const std::vector<Adaptation>& list, int first_frame);

}  // namespace relume
