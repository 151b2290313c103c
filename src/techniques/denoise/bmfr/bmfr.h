// Blockwise multi-order feature regression ([Koskela19]), except the regression itself (regression_kernel.h):
// accumulates light over frames before it, and fits after it.
#pragma once

#include "techniques/denoise/shared/light_history.h"

namespace relume {

/// Number of equally weighted samples whose mean has the variance of an exponential average with weight `alpha` of the
/// newest.
inline float independent_samples(float alpha) { return alpha > 0.0f ? (2.0f - alpha) / alpha : kInfinity; }

/// First accumulation: adds this frame's samples to the history of their surface. Also moves the history of fits.
struct BmfrAccumulateKernel {
  LightHistory history;
  View<const Rgb> fitted_before;
  View<const float> square_before;
  View<Rgb> fitted_history;  ///< fitted_before at the surface's previous position
  View<float> square;        ///< mean square of the samples' luminance
  View<uint32_t> age;        ///< sample count of the history, without this frame

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const PixelHistory pixel = history.accumulate(x, y);
    const uint32_t i = history.pixel(x, y);
    age[i] = pixel.age;
    fitted_history[i] = pixel.past(fitted_before);
    square[i] = pixel.mean(square_before, sqr(luminance(pixel.sample.light)));
  }
};

/// Second accumulation: averages the fits of one part of the light.
struct FitHistory {
  View<const Rgb> albedo;
  View<const uint32_t> age;
  View<const Rgb> history;
  View<Rgb> fitted;  ///< fit of this frame; replaced by the accumulated fit
  uint32_t max_fits = 10;

  RELUME_HD Rgb accumulate(uint32_t pixel) const {
    uint32_t n = age[pixel];
    if (n >= max_fits) n = max_fits - 1;
    const Rgb before = history[pixel];
    const bool filtered = is_filtered(albedo[pixel]);
    const Rgb after = filtered ? before + (fitted[pixel] - before) / static_cast<float>(n + 1) : before;
    fitted[pixel] = after;
    return after;
  }
};

/// Accumulates fits and computes the image from them.
struct BmfrPresentKernel {
  SurfaceLight samples;
  FitHistory fits;
  View<Rgb> shown;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    shown[pixel] = samples.image(pixel, fits.accumulate(pixel));
  }
};

/// The same with separate diffuse and specular light.
struct BmfrPresentPartsKernel {
  SplitLight samples;
  FitHistory diffuse;
  FitHistory specular;
  View<Rgb> shown;
  View<Rgb> shown_specular;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb light = specular.accumulate(pixel);
    const Rgb reflected = samples.reflects(pixel) ? samples.specular_part(pixel, light) : Rgb(0);
    shown_specular[pixel] = reflected;
    shown[pixel] = samples.image(pixel, diffuse.accumulate(pixel), reflected);
  }
};

}  // namespace relume
