#include "techniques/transport/path/settings.h"

namespace relume {

SettingList describe(PathSettings& s) {
  return {
      {"max-bounces",
       &s.max_bounces,
       "Maximum number of scattering events: 0 shows emitters only, 1 adds direct light; light from longer paths is "
       "missing",
       {.min = 0, .max = 1024, .biases = true}},
      {"russian-roulette", &s.russian_roulette,
       "End paths of low throughput at random and scale up the survivors, so that the mean is unchanged"},
      {"indirect-rate",
       &s.indirect_rate,
       "Fraction of the pixels per frame whose paths continue past the first non-specular surface; their light is "
       "scaled up, so that the mean is unchanged (estimator path)",
       {.min = 0.0625, .max = 1}},
  };
}

}  // namespace relume
