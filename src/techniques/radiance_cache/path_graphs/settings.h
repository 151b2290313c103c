// Settings of adaptive path graphs.
#pragma once

#include "settings/setting.h"
#include "techniques/radiance_cache/adaptive_psf/variance_functions.h"

namespace relume {

struct PathGraphSettings {
  float variance_constant = 0.1f;
  VarianceMeasure variance = VarianceMeasure::relative;
  float feed = 0.25f;
  int deep_coarsening = 1;
  bool guards = false;
};

/// Names without the prefix "apg.".
SettingList describe(PathGraphSettings& settings);

}  // namespace relume
