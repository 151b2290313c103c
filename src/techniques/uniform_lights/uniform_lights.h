// Every light equally often.
#pragma once

#include "lights/light.h"
#include "techniques/light_selection/infinite_lights.h"
#include "techniques/light_selection/light_selection.h"

namespace relume {

struct UniformLights {
  uint32_t count = 0;  ///< lights [0, count) take part; a constant environment does not

  RELUME_HD LightSelection sample(float u) const {
    if (count == 0) return {};
    const float scaled = u * static_cast<float>(count);
    uint32_t i = static_cast<uint32_t>(scaled);
    if (i >= count) i = count - 1;
    return {i, 1.0f / static_cast<float>(count), clamp(scaled - static_cast<float>(i), 0.0f, kOneMinusEpsilon)};
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
