// Settings of the denoiser "svgf".
#pragma once

#include "settings/setting.h"

namespace relume {

struct SvgfSettings {
  int max_history = 32;
  int max_history_changed = 8;
  int levels = 5;
  float light_tolerance = 2;
  float plane_tolerance = 1;
  float newest = 0.2f;
};

SettingList describe(SvgfSettings& settings);

}  // namespace relume
