// Setting of temporal upscaling.
#pragma once

#include "settings/setting.h"

namespace relume {

struct UpscalingSettings {
  int factor = 1;
};

/// Largest edge of a block.
inline constexpr int kMostUpscale = 4;

SettingList describe(UpscalingSettings& settings);

}  // namespace relume
