// Measures every technique in a scene: error at equal time, bias, lag and ghosting after a change, rays, memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/timed_session.h"
#include "experiments/experiment.h"
#include "experiments/survey/survey_scenes.h"
#include "experiments/survey/technique_list.h"
#include "metrics/statistics.h"
#include "relume/image_io.h"

namespace relume {

/// Effort of a survey. A quick one only shows that everything runs.
struct SurveyEffort {
  double budget_s = 0.5;    ///< time of a still image
  int repetitions = 4;      ///< of still images, with different seeds
  int runs = 3;             ///< of changes, with different seeds
  int warm_up = 12;         ///< frames before the change
  int frames = 16;          ///< frames after it
  int reference_spp = 512;  ///< samples per pixel of both references

  /// The above, or less in a quick run.
  static SurveyEffort of(const ExperimentContext& context);
};

/// Frames after the change at which ghosts are measured.
inline constexpr int kGhostFrame = 4;

/// A squared difference, averaged over pixels and channels, and its standard error. Absent: too few repetitions.
struct SquaredBias {
  double value = 0;
  std::optional<double> error = {};
};

/// Values of the images that a technique renders within the budget.
struct StillValues {
  double mse = 0;  ///< mean over the repetitions, without the reference's noise
  Interval mse_interval = {};
  double rel_mse = 0;
  double flip = 0;
  double frame_ms = 0;  ///< median
  uint32_t frames = 0;
  double time_s = 0;          ///< median over the repetitions
  double rays = 0;            ///< per pixel and frame
  uint64_t memory_bytes = 0;  ///< buffers of pixels, and structures of techniques
  SquaredBias bias2 = {};
  double variance = 0;
  Image image = {};  ///< of the first repetition
};

/// Values after the change of the scene.
struct ChangeValues {
  std::optional<size_t> lag = {};  ///< first frame whose error has settled (measure/settling.h); empty: none
  SquaredBias ghost = {};          ///< after kGhostFrame frames, minus that of sessions without the change
  Image image = {};                ///< of the first run, after kGhostFrame frames
};

struct TechniqueValues {
  SurveyTechnique technique;
  std::vector<std::pair<std::string, std::string>> slots;
  std::string refused = {};  ///< why the technique cannot run; empty: it runs
  std::string failed = {};   ///< the error that ended its measurement; empty: none
  std::optional<StillValues> still = {};
  std::optional<ChangeValues> change = {};  ///< empty: no frame depends on earlier ones after a change, or `failed`
};

struct SceneValues {
  std::string name;
  std::string change;
  double mean_square = 0;    ///< of the reference, over pixels and channels
  double reference_mse = 0;  ///< its own noise
  int reference_spp = 0;
  std::string reference_settings = {};
  Image reference = {};
  Image reference_after = {};
  std::vector<TechniqueValues> techniques;
};

/// Measures a scene. Techniques render still images alternately, repetition by repetition, in one session. If one
/// fails, its values end there, and a new session measures the others. `clock` empty: wall_clock(). Throws
/// ExperimentStopped, and Error if no session or no reference can be made.
SceneValues measure_survey(const ExperimentContext& context, const SurveyScene& scene,
                           const std::vector<SurveyTechnique>& techniques, const SurveyEffort& effort,
                           const FrameClock& clock = {});

}  // namespace relume
