// Settings of the denoiser "bmfr".
#pragma once

#include "settings/setting.h"

namespace relume {

struct BmfrSettings {
  int max_history = 32;
  int max_history_changed = 8;
  int max_fits = 10;
  float noise = 0.01f;
  float detail = 1.5f;
  float newest = 0.2f;
};

SettingList describe(BmfrSettings& settings);

}  // namespace relume
