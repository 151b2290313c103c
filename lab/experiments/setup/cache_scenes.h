// Caches of radiance, and the scenes in which experiments look at them.
#pragma once

#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// The caches of [Schipek22] and path tracing before them: "path", "psf", "apsf", "apg", "apg+apsf". Every frame shows
/// one sample a pixel and what the cells know.
std::vector<NamedSettings> cache_contenders(const ExperimentContext& context, const ExperimentScene& scene);

/// The scenes of the experiments on caches: the box, the corridor, the mine, and Sponza if it is there.
std::vector<ExperimentScene> cache_scenes(const ExperimentContext& context);

}  // namespace relume
