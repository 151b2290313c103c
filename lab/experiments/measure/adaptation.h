// Measures error per frame while techniques adapt, averaged over independent runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/measure/adapted_error.h"
#include "report/page.h"

namespace relume {

/// MSE of each frame of each run.
struct Adaptation {
  std::string name;
  std::vector<std::vector<double>> runs;  ///< by run, by frame, without the reference's noise; equal lengths

  /// MSE of a frame per run, and the mean over the last `frames` frames per run.
  std::vector<double> at(size_t frame) const;
  std::vector<double> plateaus(size_t frames) const;
  double plateau(size_t frames) const { return mean(plateaus(frames)); }
  /// Mean of `count` frames from `begin` on over that of the last quarter, by runs; 1 means adapted.
  Ratio over_plateau(size_t begin, size_t count) const;
};

/// Changes a session's scene during a run. With ranks, steps must not record anything: each rank runs them for its own
/// runs, and ranks do not share what steps store.
struct AdaptationSteps {
  /// Sets the scene to its state at the start of a run, so that runs do not depend on earlier ones.
  std::function<void(Session&)> start = {};
  /// Called before each frame, in the context of the run, which is the one to ask for a stop.
  std::function<void(const ExperimentContext& own, Session&, int frame)> before = {};
};

/// Runs a session `runs` times with different seeds, for `frames` frames each. Ranks share the runs. Errors are taken
/// over `region`. Throws ExperimentStopped.
Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PixelMask& region,
                              const AdaptationSteps& steps = {});

/// Number of averaged frames in the adaptation test: single frames are too noisy.
inline constexpr size_t kFramesThatTell = 8;

/// "1.8 (1.7 to 1.9) in the first frame, 1.02 (0.99 to 1.05) in frames 11 to 18": relative to the plateau, with frames
/// counted from 1.
std::string adaptation_text(const Adaptation& adaptation, size_t adapted);

/// Claim that frames from number `adapted` on, counted from 1, are within 10 % of the plateau.
Claim judged_adapted(std::string id, std::string paper, std::string claim, const Adaptation& adaptation,
                     size_t adapted);

/// Chart of MSE per frame, starting at number `first_frame`.
ChartBlock adaptation_chart(std::string title, std::string text, const std::vector<Adaptation>& list, int first_frame);

}  // namespace relume
