// Settings of SVGF.
#pragma once

#include "techniques/denoise/shared/history_settings.h"

namespace relume {

struct SvgfSettings {
  DenoiserHistorySettings history;
  int levels = 5;
  float light_tolerance = 2;
  float plane_tolerance = 1;
};

SettingList describe(SvgfSettings& settings);

}  // namespace relume
