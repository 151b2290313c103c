// Settings of bidirectional path tracing.
#pragma once

#include "settings/setting.h"

namespace relume {

struct BdptSettings {
  int max_light_vertices = 16;
  float connection_roulette = 0.25f;
  bool caustic_layer = false;
};

SettingList describe(BdptSettings& settings);

}  // namespace relume
