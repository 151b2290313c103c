// Scenes of the experiments on light selection and guiding, and parts of their pictures.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/pixel_mask.h"
#include "experiments/scenes.h"

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

/// The picture without pixels in which lamps or sky are seen, and without the neighbours of these: at their edges
/// single samples differ by all of their brightness, whatever the technique.
PixelMask surfaces_of(const ExperimentContext& context, const ExperimentScene& scene);

/// Samples a pixel of references in experiments on learning.
int learning_reference_spp(const ExperimentContext& context);
/// What these experiments have in common, for ExperimentResult::setup.
std::vector<std::pair<std::string, std::string>> learning_setup(const ExperimentContext& context);

/// Parts of the picture of `mine`: what the sun lights directly, and what mostly its spot lights indirectly, both told
/// by a reference and one without indirect light. All surfaces come first.
std::vector<PixelMask> mine_regions(const Image& reference, const Image& direct, const PixelMask& surfaces);

}  // namespace relume
