#include "techniques/light_sampling/power_lights/power_lights.h"

namespace relume {

std::vector<AliasEntry> build_power_lights(const LightsView& lights, LightsAtInfinity infinity) {
  const uint32_t count = lights.lights.size;
  std::vector<float> weights(count);
  double finite = 0;
  double infinite = 0;
  for (LightId i = 0; i < count; ++i) {
    if (!takes_part(lights, i, infinity)) continue;
    weights[i] = selection_weight(lights, i);
    (i < lights.first_infinite ? finite : infinite) += weights[i];
  }
  if (finite > 0 && infinite > 0) {
    for (LightId i = 0; i < count; ++i)
      weights[i] = static_cast<float>(weights[i] / (i < lights.first_infinite ? finite : infinite));
  }
  return build_alias_table(weights);
}

}  // namespace relume
