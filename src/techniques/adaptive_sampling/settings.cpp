#include "techniques/adaptive_sampling/settings.h"

#include <fmt/format.h>

#include "core/error.h"

namespace relume {

SettingList describe(AdaptiveSamplingSettings& s) {
  return {
      {"min",
       &s.min_samples,
       "Samples that every pixel gets after a change; two are the fewest that tell of noise",
       {.min = 2, .max = 4096, .biases = true}},
      {"max",
       &s.max_samples,
       "Frames after which each pixel's probability of further samples is settled; more than adaptive.min",
       {.min = 3, .max = 65536, .biases = true}},
      {"pilot", &s.pilot,
       "Leave the samples that settled the probabilities out of the picture, which removes the bias of deciding by the "
       "values that are averaged"},
  };
}

void check(const AdaptiveSamplingSettings& s) {
  if (s.max_samples > s.min_samples) return;
  throw Error(
      fmt::format("adaptive.max is {} and adaptive.min is {}, but max must be more than min; use --adaptive.max {}",
                  s.max_samples, s.min_samples, s.min_samples + 1));
}

}  // namespace relume
