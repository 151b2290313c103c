// The error of what is shown while the camera moves, with as much time for everybody.
#pragma once

#include <string>
#include <vector>

#include "compare/timed_session.h"
#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

struct MovingContender {
  std::string name;
  RenderSettings settings;
  int repetitions = 0;  ///< more of them than everybody has
};

struct MovingOptions {
  int frames = 16;  ///< of the first contender from one view to the next; whoever is slower has fewer and moves further
  int views = 2;    ///< at which the image is measured
  int repetitions = 3;
  float step_deg = 10;  ///< from one view to the next
  int reference_spp = 1024;
  FrameClock clock = {};  ///< empty: wall_clock()
};

/// Means over views and repetitions, between the shown image and a reference of the same view, whose own noise is
/// taken off the MSE.
struct MovingError {
  std::string name;
  int frames = 0;  ///< from one view to the next
  double time_share =
      1;  ///< of the time that the first contender's way from view to view took: whole frames fit as they do
  double mse = 0;
  double flip = 0;
  std::vector<double> mses = {};  ///< of each repetition, mean over its views
  Image last = {};                ///< at the last view, of the last repetition
};

struct MovingErrors {
  std::string scene;
  std::vector<MovingError> contenders;
  Image reference;  ///< of the last view
};

/// The camera turns from a view to the next, which all contenders reach after the same time: frames of a slow one are
/// fewer, and lie further apart. Contenders have turns; how many frames fit follows from the median of all that was
/// measured before, at first in rounds of their own. Requires a camera of the experiment's own.
/// Throws ExperimentStopped.
MovingErrors measure_moving(const ExperimentContext& context, const ExperimentScene& scene,
                            const std::vector<MovingContender>& contenders, const MovingOptions& options);

}  // namespace relume
