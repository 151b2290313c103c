// Settings of reservoirs for direct light.
#pragma once

#include "settings/setting.h"

namespace relume {

struct RisSettings {
  int candidates = 8;  ///< from light selection; the path's direction is one more
};

SettingList describe(RisSettings& settings);

}  // namespace relume
