// Every light equally often.
#pragma once

#include "lights/light.h"
#include "techniques/light_selection.h"

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

/// The environment, if there is one, is the last light.
inline UniformLights make_uniform_lights(const LightsView& lights) {
  const bool left_out = !lights.environment.black() && !lights.environment.worth_sampling();
  return {lights.lights.size - (left_out ? 1u : 0u)};
}

}  // namespace relume
