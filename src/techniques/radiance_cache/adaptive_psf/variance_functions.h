// Survival probability and blend as functions of a cell's variance ([Schipek22], eq. 4.1 to 4.5). The thesis'
// clamp(min, max, x) is the usual clamp of x.
#pragma once

#include "core/vec.h"

namespace relume {

/// Eq. 4.2 and 4.5 divide by zero at v1 − v0 = 8 and invert beyond.
inline constexpr float kMaxThresholdDistance = 8;

/// Variances v0 < v1 < v0 + kMaxThresholdDistance.
struct VarianceThresholds {
  float v0 = 0;
  float v1 = 1;

  RELUME_HD bool valid() const { return v0 >= 0.0f && v1 > v0 && v1 - v0 < kMaxThresholdDistance; }
};

/// Eq. 4.1.
RELUME_HD inline float linear_survival(const VarianceThresholds& t, float v) {
  return saturate((v - t.v0) / (t.v1 - t.v0));
}

/// Eq. 4.3.
RELUME_HD inline float smoothstep(float e0, float e1, float x) {
  const float s = saturate((x - e0) / (e1 - e0));
  return s * s * (3.0f - 2.0f * s);
}

/// Eq. 4.2: a ramp over about 5 (v1 − v0), with 1/3 near v0 and 2/3 near v1.
RELUME_HD inline float smooth_linear_survival(const VarianceThresholds& t, float v) {
  const float width = t.v1 - t.v0;
  const float e1 = 1.0f - width / kMaxThresholdDistance;
  return smoothstep(0.0f, e1, (v - (t.v1 + t.v0) * 0.5f) / (width * 5.0f) + e1 * 0.5f);
}

/// Eq. 4.4, weight of the cell: 0 between the thresholds.
RELUME_HD inline float step_blend(const VarianceThresholds& t, float v) { return t.v0 < v && v < t.v1 ? 0.0f : 1.0f; }

/// Eq. 4.5, weight of the cell: one minus a multiple of 1 / (16 x² + 1).
RELUME_HD inline float one_over_square_blend(const VarianceThresholds& t, float v) {
  const float width = t.v1 - t.v0;
  const float x = (v - (t.v1 + t.v0) * 0.5f) / (width * 2.0f);
  return saturate(1.0f - (1.0f - width / kMaxThresholdDistance) / (x * x * 16.0f + 1.0f));
}

enum class SurvivalFunction : int { one, linear, smooth_linear };
enum class BlendFunction : int {
  automatic,  ///< `one` for plain paths, `zero` for path graphs, which read cells themselves
  zero,
  one,
  step,
  one_over_square
};
enum class VarianceMeasure : int {
  relative,  ///< variance over squared mean, for thresholds that do not depend on the brightness of the scene
  absolute   ///< squared radiance, as in the thesis
};

enum class SurvivalMeasure : int {
  variance,       ///< variance of one sample, as in the thesis
  standard_error  ///< squared standard error of the mean, which pixels show
};

/// Probability of following a path whose cell has the variance `v`.
RELUME_HD inline float survival(SurvivalFunction function, const VarianceThresholds& t, float v) {
  switch (function) {
    case SurvivalFunction::one: return 1.0f;
    case SurvivalFunction::linear: return linear_survival(t, v);
    case SurvivalFunction::smooth_linear: return smooth_linear_survival(t, v);
  }
  return 1.0f;
}

/// Weight of a cell of variance `v` (infinite: unknown); the rest is the path's.
RELUME_HD inline float blend(BlendFunction function, const VarianceThresholds& t, float v) {
  switch (function) {
    case BlendFunction::zero: return 0.0f;
    case BlendFunction::automatic:
    case BlendFunction::one: return 1.0f;
    case BlendFunction::step: return step_blend(t, v);
    case BlendFunction::one_over_square: return one_over_square_blend(t, v);
  }
  return 1.0f;
}

}  // namespace relume
