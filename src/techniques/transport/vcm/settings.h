// Settings of vertex connection and merging.
#pragma once

#include "settings/setting.h"

namespace relume {

struct VcmSettings {
  float radius = 0.003f;
  float alpha = 0.75f;
  int pixels_per_path = 1;
  int connections = 0;
  int memory_mib = 1024;
};

SettingList describe(VcmSettings& settings);

}  // namespace relume
