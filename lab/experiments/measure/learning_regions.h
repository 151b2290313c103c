// Pixels for errors in the experiments on light selection and guiding.
#pragma once

#include <string>
#include <vector>

#include "builtin_scenes/base_plan.h"
#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

/// Pixels without visible lamps or sky in themselves or their neighbours. At such edges, single samples vary by the
/// full brightness with every technique.
PixelMask surfaces_of(const ExperimentContext& context, const ExperimentScene& scene);

/// Pixels that the material of that name covers entirely, seen from its front. Throws Error if no material has the
/// name.
PixelMask pixels_of_material(const ExperimentContext& context, const ExperimentScene& scene, const std::string& name);

/// Pixels of `region` whose centres show the inside of this room of a base, seen with the scene's camera. `reference`
/// holds the distances.
PixelMask pixels_in_room(const PixelMask& region, const Reference& reference, const CameraPose& camera,
                         const BaseRoom& room);

/// Regions of `mine`: lit directly by the sun, and lit mostly indirectly by its spot lights. Both follow from a
/// reference and one without indirect light. The list starts with all surfaces and ends with the remainder.
std::vector<PixelMask> mine_regions(const Image& reference, const Image& direct, const PixelMask& surfaces);

}  // namespace relume
