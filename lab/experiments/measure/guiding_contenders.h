// Techniques that the experiment on guiding compares in a scene.
#pragma once

#include <cstddef>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// A guided contender: its index in the errors, and the labels of its claims.
struct GuidedContender {
  size_t contender;
  const char* name;
  const char* suffix;  ///< suffix of claims
  const char* source;
};
inline constexpr GuidedContender kGuided[] = {{1, "cdq, as in the paper", "", "[Dittebrandt20 §7.1]"},
                                              {2, "cdq, lasting quadtrees", "-lasting", "[relume]"}};

/// Index in the errors of BSDF sampling with next event estimation of the environment, in scenes
/// below kLargeScale that disable it.
inline constexpr size_t kEnvironmentSampled = 3;

/// Markov chains, which account for parallax, because their targets are points [Alber25]. In scenes
/// with the visibility light cache, the light tree replaces it, also for BSDF sampling: then only chains learn.
inline constexpr const char* kChains = "mcpg";

/// Settings measured besides BSDF sampling, the paper's and lasting quadtrees, and Markov chains.
enum class GuidingExtent {
  guided,      ///< none
  departures,  ///< single departures from both; none in a quick run
  all_modes,   ///< both with all modes
  each_mode,   ///< both with all modes, and the paper's with each; as `all_modes` in a quick run
};

/// Contenders: the BSDF, the paper's settings and lasting quadtrees. Except in images of kLargeScale, next event
/// estimation of the environment, if the scene disables it, and Markov chains follow. The `extent` is last.
std::vector<NamedSettings> guiding_contenders(const ExperimentContext& context, const ExperimentScene& scene,
                                              GuidingExtent extent);

}  // namespace relume
