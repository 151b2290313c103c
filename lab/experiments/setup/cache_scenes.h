// Radiance caches, and the scenes of their experiments.
#pragma once

#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// Every path feeds the cells of its vertices, as in [Schipek22 §4.2, algorithm 2].
inline constexpr float kThesisFeed = 1;

/// Path tracing and the caches of [Schipek22]: "path", "psf", "apsf", "apg", "apg+apsf". Each frame displays one sample
/// per pixel, filtered with the cells. Path graphs have the feed kThesisFeed.
std::vector<NamedSettings> cache_contenders(const ExperimentContext& context, const ExperimentScene& scene);

/// Interpolation between cell and path [Schipek22 §4.1.2, figure 4.3 d and e]: "apsf, step" and
/// "apsf, one-over-square", which follow every path.
std::vector<NamedSettings> blend_contenders(const ExperimentContext& context, const ExperimentScene& scene);

/// Scenes of the cache experiments: the box, the corridor, the mine, the warehouse, and Sponza if available.
std::vector<ExperimentScene> cache_scenes(const ExperimentContext& context);

}  // namespace relume
