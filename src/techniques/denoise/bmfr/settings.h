// Settings of BMFR.
#pragma once

#include "techniques/denoise/shared/history_settings.h"

namespace relume {

struct BmfrSettings {
  DenoiserHistorySettings history;
  int max_fits = 10;
  float alpha = 0;
  float noise = 0.01f;
  float detail = 1.5f;
};

SettingList describe(BmfrSettings& settings);

}  // namespace relume
