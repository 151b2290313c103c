// Where errors count in the experiments on light selection and guiding.
#pragma once

#include <vector>

#include "experiments/experiment.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

/// The image without pixels in which lamps or sky are seen, and without the neighbours of these: at their edges
/// single samples differ by all of their brightness, whatever the technique.
PixelMask surfaces_of(const ExperimentContext& context, const ExperimentScene& scene);

/// Parts of the image of `mine`: what the sun lights directly, and what mostly its spot lights indirectly, both told
/// by a reference and one without indirect light. All surfaces come first.
std::vector<PixelMask> mine_regions(const Image& reference, const Image& direct, const PixelMask& surfaces);

}  // namespace relume
