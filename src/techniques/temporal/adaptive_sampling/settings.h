// Settings of adaptive sampling.
#pragma once

#include "settings/setting.h"

namespace relume {

enum class AdaptiveMethod : int { pooled, paper };
enum class AdaptiveMetric : int { linear, display };

struct AdaptiveSamplingSettings {
  AdaptiveMethod method = AdaptiveMethod::pooled;
  AdaptiveMetric metric = AdaptiveMetric::linear;
  float rate = 0.35f;
  float exposure = 0;
  int min_samples = 4;
  int max_samples = 32;
  bool pilot = false;
};

SettingList describe(AdaptiveSamplingSettings& settings);

/// Throws Error unless `max_samples` is more than `min_samples`.
void check(const AdaptiveSamplingSettings& settings);

}  // namespace relume
