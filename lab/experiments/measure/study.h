// Compares techniques on a scene with a reference, as `relume compare` does; the core of most experiments.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/comparison.h"
#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

struct StudyOptions {
  /// In the syntax of `relume compare --techniques`: "path=cache:none,psf=cache:psf,psf.cell-size:0.05".
  std::string techniques;
  /// Settings for all techniques, in addition to the scene's. The reference omits those that may bias it.
  SettingTexts common = {};
  SettingTexts reference = {};  ///< settings for the reference alone
  int spp = 1;                  ///< samples per pixel; for an animation, per frame
  double budget_s = 0;          ///< replaces spp: equal time
  /// Frame times of an animation, in seconds; empty: a still scene. Scenes follow their camera path only without a
  /// camera from the experiment.
  std::vector<float> times_s = {};
  int repetitions = 5;
  int reference_spp = 1024;
  bool timed = false;  ///< whether times at equal samples count, too; contenders then alternate on one rank of each
                       ///< machine
};

/// Runs the comparison. A quick run has two repetitions, a fortieth of the budget, at most 16 samples in the reference,
/// and small images. Throws ExperimentStopped, and Error for invalid settings.
Comparison study(const ExperimentContext& context, const ExperimentScene& scene, const StudyOptions& options);

/// Times of `count` animation frames from 0 on, at 24 per second.
std::vector<float> frame_times(int count);

/// Contender with this name. Throws Error if it is missing.
const ContenderResult& contender_named(const Comparison& comparison, std::string_view name);

/// Images, table, curves and frame times, with titles prefixed by `title`.
std::vector<Block> study_blocks(const std::string& title, const Comparison& comparison);

}  // namespace relume
