// Settings of the static light lists.
#pragma once

#include "settings/setting.h"

namespace relume {

struct StaticLightListsSettings {
  float cell_size = 0;
  int rays = 4096;
  int max_lights = 32;
  float exploration = 0.05f;
};

SettingList describe(StaticLightListsSettings& settings);

}  // namespace relume
