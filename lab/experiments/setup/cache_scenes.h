// Radiance caches, and the scenes of their experiments.
#pragma once

#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// Path tracing and the caches of [Schipek22]: "path", "psf", "apsf", "apg", "apg+apsf". Each frame displays one sample
/// per pixel, filtered with the cells.
std::vector<NamedSettings> cache_contenders(const ExperimentContext& context, const ExperimentScene& scene);

/// Scenes of the cache experiments: the box, the corridor, the mine, and Sponza if available.
std::vector<ExperimentScene> cache_scenes(const ExperimentContext& context);

}  // namespace relume
