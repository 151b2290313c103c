// Settings of the path estimator.
#pragma once

#include "settings/setting.h"

namespace relume {

struct PathSettings {
  int max_bounces = 8;  ///< scattering events after the camera
  bool russian_roulette = true;
  float indirect_rate = 1;  ///< fraction of the pixels whose paths continue past the first non-specular surface
};

SettingList describe(PathSettings& settings);

}  // namespace relume
