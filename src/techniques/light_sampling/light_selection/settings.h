// Settings shared by all light selection strategies.
#pragma once

#include "core/change.h"
#include "settings/setting.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"

namespace relume {

/// Changes that invalidate the data a strategy derives from the lights.
inline constexpr Change kRebuildsLights = Change::lights | Change::geometry | Change::materials | Change::settings;

struct LightSelectionSettings {
  bool environment = true;  ///< whether next event estimation samples the environment and suns with extent

  LightsAtInfinity infinity() const {
    return environment ? LightsAtInfinity::worth_sampling : LightsAtInfinity::unreachable;
  }
};

SettingList describe(LightSelectionSettings& settings);

}  // namespace relume
