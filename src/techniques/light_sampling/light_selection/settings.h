// Settings that all light selection strategies obey.
#pragma once

#include "core/change.h"
#include "settings/setting.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"

namespace relume {

/// Changes after which what a strategy has made of the lights is out of date.
inline constexpr Change kRebuildsLights = Change::lights | Change::geometry | Change::materials | Change::settings;

struct LightSelectionSettings {
  bool environment = true;  ///< next event estimation knows the environment

  LightsAtInfinity infinity() const {
    return environment ? LightsAtInfinity::worth_sampling : LightsAtInfinity::unreachable;
  }
};

SettingList describe(LightSelectionSettings& settings);

}  // namespace relume
