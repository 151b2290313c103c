// Blockwise multi-order feature regression ([Koskela19]), around the regression itself (regression_kernel.h): light is
// accumulated over frames before it, and what it fits is accumulated again.
#pragma once

#include "techniques/features/light_history.h"
#include "techniques/reprojection/backward.h"

namespace relume {

/// First accumulation: this frame's samples join the history of their surface. Histories of what was fitted come along.
struct BmfrAccumulateKernel {
  BackwardReprojection reprojection;
  SurfaceLight samples;
  View<const Rgb> light_before;
  View<const uint32_t> count_before;
  View<const Rgb> fitted_before;
  View<const float> square_before;
  View<Rgb> light;
  View<uint32_t> count;
  View<Rgb> fitted_history;  ///< fitted_before where this frame's surface was
  View<float> square;        ///< mean square of the samples' luminance
  View<uint32_t> age;        ///< samples that were known before this frame
  uint32_t max_samples = kNoHistoryLimit;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * reprojection.width + x;
    const SurfaceLightSample sample = samples.at(pixel);
    const BackwardTaps taps = reprojection.taps_or_nearest(x, y);
    uint32_t n = taps.least(count_before);
    if (n > max_samples) n = max_samples;
    Rgb sum = n > 0 ? taps.fetch(light_before) : Rgb(0);
    age[pixel] = n;
    fitted_history[pixel] = n > 0 ? taps.fetch(fitted_before) : Rgb(0);
    float squares = n > 0 ? taps.fetch(square_before) : 0.0f;
    if (sample.valid) {
      ++n;
      const float share = 1.0f / static_cast<float>(n);
      sum += (sample.light - sum) * share;
      squares += (sqr(luminance(sample.light)) - squares) * share;
    }
    square[pixel] = squares;
    light[pixel] = sum;  // black texels, too, carry the history of what surrounds them
    count[pixel] = n;
  }
};

/// Second accumulation, of what was fitted, and the picture that it makes.
struct BmfrPresentKernel {
  SurfaceLight samples;
  View<const uint32_t> age;
  View<const Rgb> fitted_history;
  View<Rgb> fitted;  ///< of this frame; becomes the accumulated fit
  View<Rgb> shown;
  uint32_t max_fits = 10;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    uint32_t n = age[pixel];
    if (n >= max_fits) n = max_fits - 1;
    const Rgb before = fitted_history[pixel];
    const bool filtered = is_filtered(samples.albedo[pixel]);
    const Rgb after = filtered ? before + (fitted[pixel] - before) / static_cast<float>(n + 1) : before;
    fitted[pixel] = after;
    shown[pixel] = samples.picture(pixel, after);
  }
};

}  // namespace relume
