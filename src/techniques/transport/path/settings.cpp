#include "techniques/transport/path/settings.h"

namespace relume {

SettingList describe(PathSettings& s) {
  return {
      {"max-bounces",
       &s.max_bounces,
       "Scattering events after the camera: 0 shows emitters only, 1 adds direct light; light from longer paths is "
       "missing",
       {.min = 0, .max = 1024, .biases = true}},
      {"russian-roulette", &s.russian_roulette,
       "End paths that carry little light at random, and weight the survivors so that the mean stays the same"},
  };
}

}  // namespace relume
