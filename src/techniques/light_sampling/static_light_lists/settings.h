// Settings of the static light lists.
#pragma once

#include "settings/setting.h"

namespace relume {

enum class LightListVisibility : int { rays, sets };

struct StaticLightListsSettings {
  float cell_size = 0;
  int rays = 4096;
  int max_lights = 32;
  float exploration = 0.05f;
  LightListVisibility visibility = LightListVisibility::rays;
};

SettingList describe(StaticLightListsSettings& settings);

}  // namespace relume
