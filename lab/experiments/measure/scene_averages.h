// Measures bias and variance of caches on a scene, and reports them.
#pragma once

#include <string>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/measure/frame_averages.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// Threshold text for claims about differences.
inline constexpr const char* kBeyondNoise = "a difference beyond the noise (95 %)";

/// Set of measured caches.
enum class CacheSet {
  techniques,  ///< all, blends of cells and paths, and options, with path graphs of moderate constants
  constants,   ///< all, with path graphs of all constants
};

struct SceneAverages {
  std::string name;
  Reference reference;
  std::vector<FrameAverages> caches;  ///< path tracing first
  std::vector<FrameAverages> graphs;  ///< apg for each of `constants`
  std::vector<float> constants;       ///< ascending
  /// Of kCacheOptions, with CacheSet::techniques in scenes where they are measured.
  std::vector<FrameAverages> options;
};

/// Measures the averages of a scene. Throws ExperimentStopped.
SceneAverages measure_averages(const ExperimentContext& context, const ExperimentScene& scene, CacheSet caches);

/// Adds tables, curves and images, and the test conditions.
void show_averages(const ExperimentContext& context, const std::vector<SceneAverages>& scenes,
                   ExperimentResult& result);

}  // namespace relume
