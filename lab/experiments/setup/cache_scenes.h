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

/// A setting that may become a default, or replace one. Its claims say whether it may.
struct CacheOption {
  const char* name;           ///< name of its contender
  const char* basis;          ///< name of the contender with the same cache, without the option
  const char* settings;       ///< in the syntax of `relume compare`; path graphs have the feed kThesisFeed
  double max_time;            ///< limit of the frame time, relative to path tracing's
  bool reduces_bias = false;  ///< true: the bias must be lower than without the option; false: it must not be higher
};

inline constexpr CacheOption kCacheOptions[] = {
    {"psf-coarser", "psf", "cache:psf,psf.undersampled-cells:coarser", 1.15},
    {"psf-neighbours-coarser", "psf", "cache:psf,psf.undersampled-cells:neighbours+coarser", 1.15},
    {"psf-split", "psf", "cache:psf,psf.split:true", 1.15},
    {"psf-refine", "psf", "cache:psf,psf.refine:2", 1.15, true},
    {"psf-roughness", "psf", "cache:psf,psf.roughness-bins:8", 1.15},
    {"apsf-standard-error", "apsf", "cache:apsf,apsf.survival-measure:standard-error", 0.9},
    {"apg-guards", "apg", "cache:apg,apg.guards:true,apg.feed:1", 1.2, true}};

/// The contenders of kCacheOptions, without a history.
std::vector<NamedSettings> option_contenders(const ExperimentContext& context, const ExperimentScene& scene);

/// Whether the options are measured in this scene: in a quick run, only in the box.
bool measures_options(const ExperimentContext& context, const ExperimentScene& scene);

/// Scenes of the cache experiments: the box, the corridor, the mine, the warehouse, and Sponza if available.
std::vector<ExperimentScene> cache_scenes(const ExperimentContext& context);

}  // namespace relume
