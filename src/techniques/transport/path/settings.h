// Settings of the path estimator.
#pragma once

#include "settings/setting.h"

namespace relume {

struct PathSettings {
  int max_bounces = 8;  ///< scattering events after the camera
  bool russian_roulette = true;
  float indirect_rate = 1;  ///< share of the paths that continue beyond the first surface that is no mirror
};

SettingList describe(PathSettings& settings);

}  // namespace relume
