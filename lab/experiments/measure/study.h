// What most experiments are made of: several techniques on a scene, against a reference, as `relume compare` measures
// them.
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
  /// As `relume compare --techniques` takes them: "path=cache:none,psf=cache:psf,psf.cell-size:0.05".
  std::string techniques;
  /// Settings for everybody, on top of the scene's. Those that might bias it do not reach the reference.
  SettingTexts common = {};
  SettingTexts reference = {};  ///< settings of the reference alone
  int spp = 1;                  ///< samples a pixel; of each frame of an animation
  double budget_s = 0;          ///< instead of spp: equal time
  /// Frames of an animation, seconds; empty: the still scene. Only scenes without a camera of the experiment's own
  /// move along their camera path.
  std::vector<float> times_s = {};
  int repetitions = 5;
  int reference_spp = 1024;
};

/// A quick run has two repetitions, a fortieth of the budget, at most 16 samples in the reference, and small images.
/// Throws ExperimentStopped, and Error for settings that do not fit.
Comparison study(const ExperimentContext& context, const ExperimentScene& scene, const StudyOptions& options);

/// Frame times of an animation: `count` of them from 0 on, 24 a second.
std::vector<float> frame_times(int count);

/// The contender of that name. Throws Error if there is none.
const ContenderResult& contender_named(const Comparison& comparison, std::string_view name);

/// Images, table, curves and frame times, with `title` before their titles.
std::vector<Block> study_blocks(const std::string& title, const Comparison& comparison);

}  // namespace relume
