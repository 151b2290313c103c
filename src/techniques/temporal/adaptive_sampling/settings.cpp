#include "techniques/temporal/adaptive_sampling/settings.h"

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {

SettingList describe(AdaptiveSamplingSettings& s) {
  return {
      {"method", choice(s.method, {"pooled", "paper"}),
       "pooled: in proportion to the standard deviation, estimated from the surrounding pixels in every frame; paper: "
       "from the pixel's own relative deviation, fixed after adaptive.max frames"},
      {"metric", choice(s.metric, {"linear", "display"}),
       "Quantity whose deviation is estimated: radiance, or its value on a display (pooled)"},
      {"rate",
       &s.rate,
       "Minimum mean number of samples per pixel and frame; images with even noise get more (pooled)",
       {.min = 0.01, .max = 1}},
      {"exposure",
       &s.exposure,
       "Exposure at which the image will be displayed (adaptive.metric display)",
       {.min = -30, .max = 30, .unit = "stops"}},
      {"min",
       &s.min_samples,
       "Samples that every pixel gets after a change; at least two, to estimate noise",
       {.min = 2, .max = 4096, .biases = true}},
      {"max",
       &s.max_samples,
       "Frames after which the sampling probability of each pixel is fixed (paper, or with adaptive.pilot); more than "
       "adaptive.min",
       {.min = 3, .max = 65536, .biases = true}},
      {"pilot", &s.pilot,
       "Exclude the samples that determined the probabilities from the image, which removes the bias of adaptive "
       "sampling"},
  };
}

void check(const AdaptiveSamplingSettings& s) {
  if (s.max_samples > s.min_samples) return;
  throw Error(
      fmt::format("adaptive.max is {} and adaptive.min is {}, but max must be more than min; use --adaptive.max {}",
                  s.max_samples, s.min_samples, s.min_samples + 1));
}

}  // namespace relume
