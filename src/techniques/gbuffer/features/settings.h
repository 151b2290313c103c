// Settings shared by all denoisers.
#pragma once

#include "settings/setting.h"

namespace relume {

struct FeatureSettings {
  int edge_rays = 16;
  bool split = true;
};

SettingList describe(FeatureSettings& settings);

}  // namespace relume
