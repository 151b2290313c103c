// Scenes of the experiments on light selection and guiding, and what these have in common.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// A built-in scene at rest, with two indirect rays as in [Dittebrandt20 §7].
ExperimentScene learning_scene(std::string_view name);

/// 256 lamps of all strengths over a plain: nothing hides anything.
ExperimentScene lamp_field();

/// Sponza at night with 200 lamps in its arcades; std::nullopt if it is not there. Throws Error if it cannot be read.
std::optional<ExperimentScene> sponza_with_lamps(const ExperimentContext& context);

/// The scene with the light selection that references are rendered with: the light tree, which learns nothing, and has
/// far less noise than power where lamps are many.
ExperimentScene plainly_sampled(ExperimentScene scene);

/// Quadtrees that remember, spread what a leaf found to those around it, and move several leaves a frame: better than
/// the paper's while nothing moves.
void use_lasting_quadtrees(RenderSettings& settings);
/// A light cache that forgets, explores by one table and chooses among buckets evenly, as in the paper.
void use_paper_cache(RenderSettings& settings);

/// Samples a pixel of references in experiments on learning.
int learning_reference_spp(const ExperimentContext& context);
/// What these experiments have in common, for ExperimentResult::setup.
std::vector<std::pair<std::string, std::string>> learning_setup(const ExperimentContext& context);

}  // namespace relume
