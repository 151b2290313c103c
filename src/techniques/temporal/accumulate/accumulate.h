// Mean and variance of the samples of each pixel, updated sample by sample ([Welford62]).
#pragma once

#include "core/vec.h"
#include "core/view.h"
#include "techniques/temporal/accumulate/light_film.h"

namespace relume {

struct AccumulateKernel {
  View<const Rgb> radiance;         ///< of this frame's sample
  View<const uint32_t> rays;        ///< traced for it
  View<const uint32_t> allocation;  ///< samples that the pixel got in this frame, 0 or 1; empty: 1
  View<Rgb> mean;
  View<float> m2;    ///< sum of squared distances of the samples' luminance from its mean
  View<Rgb> m2_rgb;  ///< the same for each channel by itself; may be empty
  View<uint32_t> count;
  View<uint32_t> taken;  ///< elements of its sequence that the pixel has used; may be empty
  View<uint32_t> ray_sum;
  View<uint32_t> nonfinite;  ///< counts samples that were not finite and are taken as black
  LightFilm film;            ///< of light paths, which `radiance` and `mean` contain
  bool keep = true;          ///< false: this frame's sample replaces what was there
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    ray_sum[pixel] += rays[pixel];
    const Rgb film_before = film.mean_of(pixel);
    film.add(pixel);
    const Rgb film_after = film.mean_of(pixel);
    if (!allocation.empty() && allocation[pixel] == 0) {
      if (!film.empty()) mean[pixel] += film_after - film_before;
      return;
    }
    if (!taken.empty()) ++taken[pixel];
    Rgb value = film.empty() ? radiance[pixel] : radiance[pixel] - film.splat(pixel);
    if (!is_finite(value)) {
      ++nonfinite[pixel];
      value = Rgb(0);
    }
    const uint32_t n = keep ? count[pixel] + 1 : 1;
    const Rgb before = n > 1 ? mean[pixel] - film_before : Rgb(0);
    const Rgb after = before + (value - before) / static_cast<float>(n);
    const float square = luminance(value - before) * luminance(value - after);
    if (!m2_rgb.empty()) m2_rgb[pixel] = n > 1 ? m2_rgb[pixel] + (value - before) * (value - after) : Rgb(0);
    mean[pixel] = after + film_after;
    m2[pixel] = n > 1 ? m2[pixel] + square : 0.0f;
    count[pixel] = n;
  }
};

/// Variance of the mean of `n` samples (unbiased); 0 below two samples.
RELUME_HD inline float variance_of_mean(float m2, uint32_t n) {
  return n < 2 ? 0.0f : m2 / (static_cast<float>(n) * static_cast<float>(n - 1));
}

}  // namespace relume
