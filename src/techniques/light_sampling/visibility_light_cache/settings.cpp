#include "techniques/light_sampling/visibility_light_cache/settings.h"

#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"

namespace relume {

SettingList describe(VisibilityLightCacheSettings& s) {
  return {
      {"bucket-size", &s.bucket_size, "Lights that are weighed at a point", {.min = 1, .max = kMaxBucketSize}},
      {"exploration", &s.exploration, "Share of samples among all lights", {.min = 0.001, .max = 1}},
      {"hysteresis",
       &s.hysteresis,
       "Share of the buckets' room that must suffice before there are fewer of them than in the frame before",
       {.min = 0, .max = 1}},
      {"max-samples", &s.max_samples, "Samples of a region that are looked at", {.min = 1, .max = 1 << 24}},
      {"memory",
       &s.memory,
       "Frames for which a region remembers lights that it did not see again",
       {.min = 0, .max = CachedLight::kMaxAge - 1}},
      {"even-buckets",
       &s.even_buckets,
       "Share of the choice among a region's buckets that is even; the rest goes by their lights' power and distance; "
       "1: the paper's",
       {.min = 0.01, .max = 1}},
      {"energy-weight",
       &s.energy_weight,
       "Part of exploration that goes by the lights' power",
       {.min = 0.01, .max = 1e3}},
      {"change-weight",
       &s.change_weight,
       "Part of exploration that goes to lights that have just changed",
       {.min = 0, .max = 1e3}},
      {"distance-weight",
       &s.distance_weight,
       "Part of exploration that goes by the distance from light to cell, or to the camera if there is one cell",
       {.min = 0, .max = 1e3}},
      {"exploration-cells",
       &s.exploration_cells,
       "Cells along the longest side of the lights' box, each with its own distances for exploration; 1: the paper's",
       {.min = 1, .max = 64}},
  };
}

}  // namespace relume
