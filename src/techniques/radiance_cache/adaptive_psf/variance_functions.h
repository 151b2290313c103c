// How the variance of a cell decides whether a path is followed and how much of the cell is shown ([Schipek22], eq. 4.1
// to 4.5). Where the thesis writes clamp(min, max, x), this is the usual clamp of x.
#pragma once

#include "core/vec.h"

namespace relume {

/// Eq. 4.2 and 4.5 divide by zero at v1 − v0 = 8 and turn over beyond.
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

/// Eq. 4.2: a ramp over about five times v1 − v0, with 1/3 near v0 and 2/3 near v1.
RELUME_HD inline float smooth_linear_survival(const VarianceThresholds& t, float v) {
  const float width = t.v1 - t.v0;
  const float e1 = 1.0f - width / kMaxThresholdDistance;
  return smoothstep(0.0f, e1, (v - (t.v1 + t.v0) * 0.5f) / (width * 5.0f) + e1 * 0.5f);
}

/// Eq. 4.4: paths alone between the thresholds. Weight of the cell.
RELUME_HD inline float step_blend(const VarianceThresholds& t, float v) { return t.v0 < v && v < t.v1 ? 0.0f : 1.0f; }

/// Eq. 4.5: one over x². Weight of the cell.
RELUME_HD inline float one_over_square_blend(const VarianceThresholds& t, float v) {
  const float width = t.v1 - t.v0;
  const float x = (v - (t.v1 + t.v0) * 0.5f) / (width * 2.0f);
  return saturate(1.0f - (1.0f - width / kMaxThresholdDistance) / (x * x * 16.0f + 1.0f));
}

enum class SurvivalFunction : int { one, linear, smooth_linear };
enum class BlendFunction : int {
  automatic,  ///< one where paths are plain ones, zero where they are path graphs, which read cells themselves
  zero,
  one,
  step,
  one_over_square
};
enum class VarianceMeasure : int {
  relative,  ///< variance over squared mean: thresholds do not depend on how bright the scene is
  absolute   ///< squared radiance, as in the thesis
};

/// Probability with which a path is followed where the cell's variance is `v`.
RELUME_HD inline float survival(SurvivalFunction function, const VarianceThresholds& t, float v) {
  switch (function) {
    case SurvivalFunction::one: return 1.0f;
    case SurvivalFunction::linear: return linear_survival(t, v);
    case SurvivalFunction::smooth_linear: return smooth_linear_survival(t, v);
  }
  return 1.0f;
}

/// Weight of the cell, the rest being the path's, where the cell's variance is `v`; infinite if it is not known.
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
