// Settings of the light selection "neeat".
#pragma once

#include "settings/setting.h"

namespace relume {

/// Defaults of [Rtxpt26], except longest_epoch.
struct AdaptiveTilesSettings {
  float local = 0.65f;
  float feedback = 0.75f;
  int tile_size = 8;
  int list_size = 128;
  int radius = 16;
  float depth_tolerance = 1.5f;
  bool jitter = true;
  int longest_epoch = 64;
};

SettingList describe(AdaptiveTilesSettings& settings);

}  // namespace relume
