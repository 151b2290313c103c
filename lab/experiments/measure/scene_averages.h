// Bias and variance of caches on a scene, and how a page shows them.
#pragma once

#include <string>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/frame_averages.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// What claims about a difference of two figures call their threshold.
inline constexpr const char* kBeyondNoise = "a difference beyond the noise (95 %)";

/// Whose averages are measured.
enum class CacheSet {
  techniques,  ///< everybody's, of path graphs with moderate constants
  constants,   ///< everybody's, of path graphs with all constants
};

struct SceneAverages {
  std::string name;
  Reference reference;
  std::vector<FrameAverages> caches;  ///< path tracing first
  std::vector<FrameAverages> graphs;  ///< apg with each of `constants`
  std::vector<float> constants;       ///< growing
};

/// Throws ExperimentStopped.
SceneAverages measure_averages(const ExperimentContext& context, const ExperimentScene& scene, CacheSet caches);

/// Adds tables, curves and images, and says what was rendered.
void show_averages(const ExperimentContext& context, const std::vector<SceneAverages>& scenes,
                   ExperimentResult& result);

}  // namespace relume
