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
  /// First frame whose mean MSE is within `share` of the plateau, the mean of the last quarter, and after which none
  /// is above that by more than twice its standard error. The number of frames if there is none.
  size_t adapted_after(double share) const;
  /// 95 % interval of that, by bootstrap over the runs.
  Interval adapted_interval(double share) const;
};

/// Runs a session `runs` times with different seeds; `before` is called with the number of the frame before each of
/// `frames` frames. `region`: of the picture, in which errors count. Throws ExperimentStopped.
Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PixelMask& region,
                              const std::function<void(Session&, int frame)>& before = {});

/// "6 (4 to 9)": the frame of adapted_after() with its interval, both counted from `first_frame`.
std::string adapted_text(const Adaptation& adaptation, double share, int first_frame);

/// Curves of MSE against frames, the first of which is number `first_frame`.
ChartBlock adaptation_chart(std::string title, std::string text, const std::vector<Adaptation>& list, int first_frame);

}  // namespace relume
