#include "techniques/light_sampling/visibility_light_cache/settings.h"

#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"

namespace relume {

SettingList describe(VisibilityLightCacheSettings& s) {
  return {
      {"bucket-size",
       &s.bucket_size,
       "Maximum number of lights weighted per choice",
       {.min = 1, .max = kMaxBucketSize}},
      {"exploration", &s.exploration, "Fraction of samples drawn from all lights", {.min = 0.001, .max = 1}},
      {"learn-exploration", &s.learn_exploration,
       "Learn the exploring fraction in each region from the rate at which it finds new lights; starts from "
       "exploration"},
      {"exploration-floor",
       &s.exploration_floor,
       "Minimum fraction of samples drawn from all lights with learn-exploration",
       {.min = 0.001, .max = 1}},
      {"hysteresis",
       &s.hysteresis,
       "The number of buckets shrinks only if the lights then fill at most this fraction of each bucket",
       {.min = 0, .max = 1}},
      {"max-samples", &s.max_samples, "Maximum number of samples read per region", {.min = 1, .max = 1 << 24}},
      {"memory",
       &s.memory,
       "Frames for which a region keeps a light after its last unoccluded ray",
       {.min = 0, .max = CachedLight::kMaxAge - 1}},
      {"even-buckets",
       &s.even_buckets,
       "Probability of choosing a bucket uniformly, otherwise by the power and distance of its lights; 1: the paper",
       {.min = 0.01, .max = 1}},
      {"energy-weight", &s.energy_weight, "Weight of the lights' power in exploration", {.min = 0.01, .max = 1e3}},
      {"change-weight",
       &s.change_weight,
       "Weight in exploration of lights that have just changed",
       {.min = 0, .max = 1e3}},
      {"change-measure", choice(s.change_measure, {"flag", "amount"}),
       "Changed lights are explored equally, or by the amount of the change of their power and position"},
      {"distance-weight",
       &s.distance_weight,
       "Weight in exploration of the distance from light to cell, or to the camera if there is one cell",
       {.min = 0, .max = 1e3}},
      {"exploration-cells",
       &s.exploration_cells,
       "Exploration cells along the longest side of the lights' bounds, each with its own distances; 1: the paper",
       {.min = 1, .max = 64}},
      {"infinite", choice(s.infinite, {"entries", "apart"}),
       "Suns and the sky: entries of the regions' lists, weighted by their visibility from the region; or apart, with "
       "half of the samples"},
  };
}

}  // namespace relume
