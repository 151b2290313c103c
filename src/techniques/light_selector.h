// The slot "light selection": which light next event estimation samples. A closed list and one switch; a new strategy
// adds a member, a kind and a case.
#pragma once

#include "scene/surface_point.h"
#include "techniques/light_selection.h"
#include "techniques/power_lights/power_lights.h"
#include "techniques/uniform_lights/uniform_lights.h"

namespace relume {

enum class LightSelectorKind : int { uniform, power };
inline constexpr int kLightSelectorKindCount = 2;

struct LightSelector {
  LightSelectorKind kind = LightSelectorKind::power;
  UniformLights uniform;
  PowerLights power;

  /// A light for next event estimation at `sp`; pmf 0 if there is none.
  RELUME_HD LightSelection sample([[maybe_unused]] const SurfacePoint& sp, float u) const {
    switch (kind) {
      case LightSelectorKind::uniform: return uniform.sample(u);
      case LightSelectorKind::power: return power.sample(u);
    }
    return {};
  }

  /// Probability with which sample() chooses `light` at `sp`.
  RELUME_HD float pmf([[maybe_unused]] const SurfacePoint& sp, LightId light) const {
    switch (kind) {
      case LightSelectorKind::uniform: return uniform.pmf(light);
      case LightSelectorKind::power: return power.pmf(light);
    }
    return 0.0f;
  }
};

}  // namespace relume
