#include "techniques/temporal/adaptive_sampling/settings.h"

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {

SettingList describe(AdaptiveSamplingSettings& s) {
  return {
      {"method", choice(s.method, {"pooled", "paper"}),
       "pooled: samples in proportion to the standard deviation, which the pixels around estimate in every frame; "
       "paper: from the pixel's own relative deviation, settled after adaptive.max frames"},
      {"metric", choice(s.metric, {"linear", "display"}),
       "What the deviation is of: radiance, or what a display shows of it (pooled)"},
      {"rate",
       &s.rate,
       "Lower bound of the average number of samples per pixel and frame, which is higher in images with even noise "
       "(pooled)",
       {.min = 0.01, .max = 1}},
      {"exposure",
       &s.exposure,
       "Exposure at which the image will be seen (adaptive.metric display)",
       {.min = -30, .max = 30, .unit = "stops"}},
      {"min",
       &s.min_samples,
       "Samples that every pixel gets after a change; two are the fewest that tell of noise",
       {.min = 2, .max = 4096, .biases = true}},
      {"max",
       &s.max_samples,
       "Frames after which each pixel's probability of further samples is settled (paper, and adaptive.pilot); more "
       "than adaptive.min",
       {.min = 3, .max = 65536, .biases = true}},
      {"pilot", &s.pilot,
       "Leave the samples that settled the probabilities out of the image, which removes the bias of deciding by the "
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
