// Error against frames while techniques adapt, averaged over independent runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/adapted_error.h"
#include "report/page.h"

namespace relume {

/// Mean over the runs of each frame's MSE.
struct Adaptation {
  std::string name;
  std::vector<double> mse;             ///< by frame, without the reference's noise
  std::vector<double> standard_error;  ///< of that
  Image last;                          ///< the last frame of the last run

  /// Mean over the last `frames` frames.
  double plateau(size_t frames) const;
  /// First frame from which on the mean over `window` frames stays within `share` of the plateau, which is the mean of
  /// the last quarter.
  size_t adapted_after(double share, size_t window = 3) const;
};

/// Runs a session `runs` times with different seeds; `before` is called with the number of the frame before each of
/// `frames` frames. `region`: of the picture, in which errors count. Throws ExperimentStopped.
Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PictureRegion& region,
                              const std::function<void(Session&, int frame)>& before = {});

/// Curves of MSE against frames, the first of which is number `first_frame`.
ChartBlock adaptation_chart(std::string title, std::string text, const std::vector<Adaptation>& list, int first_frame);

}  // namespace relume
