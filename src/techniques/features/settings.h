// Settings that all denoisers share.
#pragma once

#include "settings/setting.h"

namespace relume {

struct FeatureSettings {
  int edge_rays = 16;
};

SettingList describe(FeatureSettings& settings);

}  // namespace relume
