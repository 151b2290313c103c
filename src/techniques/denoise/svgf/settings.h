// Settings of the denoiser "svgf".
#pragma once

#include "techniques/gbuffer/features/history_settings.h"

namespace relume {

struct SvgfSettings {
  DenoiserHistorySettings history;
  int levels = 5;
  float light_tolerance = 2;
  float plane_tolerance = 1;
};

SettingList describe(SvgfSettings& settings);

}  // namespace relume
