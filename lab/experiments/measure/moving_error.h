// Measures the error of images while the camera moves or the scene changes, at equal time or for equal numbers of
// frames.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "compare/timed_session.h"
#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

struct MovingContender {
  std::string name;
  RenderSettings settings;
  int repetitions = 0;  ///< minimum for this contender
};

struct MovingOptions {
  int frames = 16;            ///< frames per view step of the first contender; slower ones render fewer
  bool equal_frames = false;  ///< all contenders render `frames`, in different times
  int views = 2;              ///< measured views
  int repetitions = 3;
  float step_deg = 10;         ///< turn of the camera from one view to the next, degrees
  float step_m = 0;            ///< forward motion of the camera from one view to the next, metres
  float animation_step_s = 0;  ///< animation time from one view to the next, seconds; 0: it does not change
  int reference_spp = 1024;
  /// Settings of references in the syntax of apply_settings(), beyond those of plainly_sampled().
  std::string reference = {};
  FrameClock clock = {};  ///< empty: wall_clock()
};

/// Means over views and repetitions, between the displayed image and a reference of the same view. The reference's
/// noise is subtracted from the MSE.
struct MovingError {
  std::string name;
  int frames = 0;         ///< per view step
  double time_share = 1;  ///< time per view step relative to the first contender; frames are whole
  double mse = 0;
  double flip = 0;
  std::vector<double> mses = {};   ///< per repetition: mean over its views
  std::vector<double> flips = {};  ///< the same of FLIP
  Image last = {};                 ///< last view of the last repetition
};

constexpr auto members_of(const MovingError*) {
  return std::tuple(&MovingError::name, &MovingError::frames, &MovingError::time_share, &MovingError::mse,
                    &MovingError::flip, &MovingError::mses, &MovingError::flips, &MovingError::last);
}

struct MovingErrors {
  std::string scene;
  std::vector<MovingError> contenders;
  Image reference;           ///< last view
  double reference_mse = 0;  ///< of the references themselves: mean over the views
};
constexpr auto members_of(const MovingErrors*) {
  return std::tuple(&MovingErrors::scene, &MovingErrors::contenders, &MovingErrors::reference,
                    &MovingErrors::reference_mse);
}

/// Moves the camera from view to view, by turned_ahead(). The first view is the scene's, and the motion begins a step
/// before it. The animation then is at the time of the scene's settings. By default, each step takes all contenders the
/// same time, so slower ones render fewer frames, with larger motion between them. With `equal_frames`, all render
/// `frames` frames. Contenders take turns. The frame count follows from the median of all earlier timings, which start
/// with separate rounds. Requires a camera in the experiment's scene. Results of an interrupted experiment are reused.
/// Throws ExperimentStopped.
MovingErrors measure_moving(const ExperimentContext& context, const ExperimentScene& scene,
                            const std::vector<MovingContender>& contenders, const MovingOptions& options);

}  // namespace relume
