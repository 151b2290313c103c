#include "techniques/radiance_cache/adaptive_psf/settings.h"

#include <fmt/format.h>

#include "relume/error.h"
#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

namespace relume {
namespace {

VarianceThresholds checked(const char* name, float v0, float v1) {
  const VarianceThresholds t{v0, v1};
  if (!t.valid()) {
    throw Error(fmt::format("apsf.{0}-v0 is {1} and apsf.{0}-v1 is {2}, but v1 must exceed v0, by less than {3}", name,
                            v0, v1, kMaxThresholdDistance));
  }
  return t;
}

}  // namespace

SettingList describe(AdaptivePsfSettings& s) {
  return {
      {"survival", choice(s.survival, {"one", "linear", "smooth-linear"}),
       "Probability that a path is followed: always 1, or rising between the thresholds with the variance of its cell"},
      {"survival-v0", &s.survival_v0, "Variance below which few paths are followed", {.min = 0, .max = 1e6}},
      {"survival-v1", &s.survival_v1, "Variance above which most paths are followed", {.min = 0, .max = 1e6}},
      {"survival-measure", choice(s.survival_measure, {"variance", "standard-error"}),
       "Measure that survival depends on: the variance of one sample in the cell, or the squared standard error of the "
       "cell's mean (variance / samples), with which all paths of black and changed cells are followed"},
      {"error-v0", &s.error_v0, "Squared standard error below which few paths are followed", {.min = 0, .max = 1e6}},
      {"error-v1", &s.error_v1, "Squared standard error above which most paths are followed", {.min = 0, .max = 1e6}},
      {"survival-floor",
       &s.survival_floor,
       "Minimum probability that a path is followed, so that cells can adapt to changes",
       {.min = 0.001, .max = 1}},
      {"min-samples",
       &s.min_samples,
       "Samples below which a cell's variance is unreliable and all its paths are followed; lower values can leave "
       "cells dark where bright samples are rare",
       {.min = 1, .max = 1 << 20, .biases = true}},
      {"blend",
       choice(s.blend, {"automatic", "zero", "one", "step", "one-over-square"}),
       "Weight of the cell in a pixel whose path was followed: zero, one, or a curve (step, one-over-square) that "
       "dips between the thresholds; automatic: one with apsf, zero with apsf+apg, whose path graph already weights "
       "cells",
       {.biases = true}},
      {"blend-v0",
       &s.blend_v0,
       "Variance above which paths are preferred to cells",
       {.min = 0, .max = 1e6, .biases = true}},
      {"blend-v1",
       &s.blend_v1,
       "Variance above which cells are preferred again",
       {.min = 0, .max = 1e6, .biases = true}},
      {"variance", choice(s.variance, {"relative", "absolute"}),
       "Unit of variances and squared standard errors: the squared mean of the cell, or absolute"},
  };
}

void check(const AdaptivePsfSettings& settings) { make_adaptive_psf(settings); }

AdaptivePsf make_adaptive_psf(const AdaptivePsfSettings& s, BlendFunction automatic) {
  AdaptivePsf a;
  a.survival_function = s.survival;
  a.blend_function = s.blend == BlendFunction::automatic ? automatic : s.blend;
  a.measure = s.variance;
  a.survival_measure = s.survival_measure;
  const VarianceThresholds variances = checked("survival", s.survival_v0, s.survival_v1);
  const VarianceThresholds errors = checked("error", s.error_v0, s.error_v1);
  a.survival_thresholds = s.survival_measure == SurvivalMeasure::variance ? variances : errors;
  a.blend_thresholds = checked("blend", s.blend_v0, s.blend_v1);
  a.survival_floor = s.survival_floor;
  a.min_count = static_cast<float>(s.min_samples);
  return a;
}

}  // namespace relume
