// Modes of octree, quadtrees and light cache that are off by default, and the claims that decide their defaults.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/measure/ratio.h"
#include "render/render_settings.h"

namespace relume {

struct LearningMode {
  std::string_view id;    ///< kebab-case, in the ids of claims
  std::string_view name;  ///< in the names of contenders
  void (*apply)(RenderSettings& settings);
};

/// Modes of octree and quadtrees; all together in the last.
std::span<const LearningMode> guiding_modes();
/// Modes of octree and light cache; all together in the last.
std::span<const LearningMode> cache_modes();
/// The modes to measure: only the last in a quick run.
std::span<const LearningMode> modes_to_measure(const ExperimentContext& context, std::span<const LearningMode> modes);

/// Name of a contender: "BASE, MODE".
std::string with_mode(std::string_view base, const LearningMode& mode);

/// Factor by which a mode lowers the MSE in a scene.
struct ModeGain {
  std::string scene;
  Ratio ratio;
};

/// Claims that the mode lowers the error in each scene of `gains`. `id`: prefix of the claim's id. `base`: the settings
/// that the mode is added to; `where`: ends the sentence.
void claim_gain(std::string_view id, const LearningMode& mode, std::string_view base, std::string_view where,
                const std::vector<ModeGain>& gains, std::vector<Claim>& claims);
/// Claims that the mode raises the MSE by 2 % at most in each of these scenes.
void claim_harmless(std::string_view id, const LearningMode& mode, std::string_view base,
                    const std::vector<ModeGain>& gains, std::vector<Claim>& claims);

}  // namespace relume
