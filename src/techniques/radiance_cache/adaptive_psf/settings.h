// Settings of adaptive path space filtering.
#pragma once

#include "settings/setting.h"
#include "techniques/radiance_cache/adaptive_psf/variance_functions.h"

namespace relume {

struct AdaptivePsf;

struct AdaptivePsfSettings {
  SurvivalFunction survival = SurvivalFunction::smooth_linear;
  float survival_v0 = 0.5f;
  float survival_v1 = 2.0f;
  SurvivalMeasure survival_measure = SurvivalMeasure::variance;
  float error_v0 = 0.002f;
  float error_v1 = 0.008f;
  float survival_floor = 0.1f;
  int min_samples = 128;
  BlendFunction blend = BlendFunction::automatic;
  float blend_v0 = 0.05f;
  float blend_v1 = 0.2f;
  VarianceMeasure variance = VarianceMeasure::relative;
};

/// Names without the prefix "apsf.".
SettingList describe(AdaptivePsfSettings& settings);

/// Throws Error if thresholds are outside the domain of their functions.
void check(const AdaptivePsfSettings& settings);

/// Parameters for kernels. `automatic`: the blend for BlendFunction::automatic. Throws as check() does.
AdaptivePsf make_adaptive_psf(const AdaptivePsfSettings& settings, BlendFunction automatic = BlendFunction::one);

}  // namespace relume
