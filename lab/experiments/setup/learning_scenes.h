// Scenes and settings of the experiments on light selection and guiding.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// A static built-in scene with two indirect rays, as in [Dittebrandt20 §7].
ExperimentScene learning_scene(std::string_view name);

/// 256 lamps of varying power over a plain, without occlusion.
ExperimentScene lamp_field();

/// Sponza at night with 200 lamps in its arcades; std::nullopt if unavailable. Throws Error if it cannot be read.
std::optional<ExperimentScene> sponza_with_lamps(const ExperimentContext& context);

/// The scene with the light selection of references: the light tree, which does not learn and has much less noise than
/// sampling by power with many lamps.
ExperimentScene plainly_sampled(ExperimentScene scene);

/// Sets quadtrees with a memory, spreading to neighbouring leaves and several migrations per frame: better than the
/// paper's in static scenes.
void use_lasting_quadtrees(RenderSettings& settings);
/// Sets the paper's light cache, as the preset `paper-002` does: no memory, uniform buckets, and a single table for
/// exploration, which weighs changed lights by the amount of the change.
void use_paper_cache(RenderSettings& settings);

/// Samples per pixel of references in learning experiments; fewer at a large image `scale` (ExperimentScene).
int learning_reference_spp(const ExperimentContext& context, int scale = 1);
/// Common conditions of these experiments, for ExperimentResult::setup.
std::vector<std::pair<std::string, std::string>> learning_setup(const ExperimentContext& context);

}  // namespace relume
