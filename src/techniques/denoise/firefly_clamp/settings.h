// Settings of the firefly clamp.
#pragma once

#include "settings/setting.h"

namespace relume {

struct FireflySettings {
  float limit = 0;
};

SettingList describe(FireflySettings& settings);

}  // namespace relume
