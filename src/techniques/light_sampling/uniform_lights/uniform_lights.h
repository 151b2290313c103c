// Light selection with equal probabilities.
#pragma once

#include "lights/light.h"
#include "sampling/choose.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"
#include "techniques/light_sampling/light_selection/light_selection.h"

namespace relume {

struct UniformLights {
  uint32_t count = 0;  ///< lights [0, count) take part

  RELUME_HD LightSelection sample(ReusableNumber n) const {
    if (count == 0) return {};
    const uint32_t i = choose_evenly(count, n);
    return {i, 1.0f / static_cast<float>(count), n.u};
  }
  RELUME_HD float pmf(LightId light) const { return light < count ? 1.0f / static_cast<float>(count) : 0.0f; }
};

/// All lights up to the last one that takes part.
inline UniformLights make_uniform_lights(const LightsView& lights,
                                         LightsAtInfinity infinity = LightsAtInfinity::worth_sampling) {
  uint32_t count = lights.lights.size;
  while (count > 0 && !takes_part(lights, count - 1, infinity)) --count;
  return {count};
}

}  // namespace relume
