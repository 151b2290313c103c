// Mean and variance of the samples of each pixel, updated sample by sample ([Welford62]).
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

struct AccumulateKernel {
  View<const Rgb> radiance;         ///< of this frame's sample
  View<const uint32_t> rays;        ///< traced for it
  View<const uint32_t> allocation;  ///< samples that the pixel got in this frame, 0 or 1; empty: 1
  View<Rgb> mean;
  View<float> m2;    ///< sum of squared distances of the samples' luminance from its mean
  View<Rgb> m2_rgb;  ///< the same for each channel by itself; may be empty
  View<uint32_t> count;
  View<uint32_t> ray_sum;
  View<uint32_t> nonfinite;  ///< counts samples that were not finite and are taken as black
  bool keep = true;          ///< false: this frame's sample replaces what was there
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    ray_sum[pixel] += rays[pixel];
    if (!allocation.empty() && allocation[pixel] == 0) return;
    Rgb value = radiance[pixel];
    if (!is_finite(value)) {
      ++nonfinite[pixel];
      value = Rgb(0);
    }
    const uint32_t n = keep ? count[pixel] + 1 : 1;
    const Rgb before = n > 1 ? mean[pixel] : Rgb(0);
    const Rgb after = before + (value - before) / static_cast<float>(n);
    const float square = luminance(value - before) * luminance(value - after);
    if (!m2_rgb.empty()) m2_rgb[pixel] = n > 1 ? m2_rgb[pixel] + (value - before) * (value - after) : Rgb(0);
    mean[pixel] = after;
    m2[pixel] = n > 1 ? m2[pixel] + square : 0.0f;
    count[pixel] = n;
  }
};

/// Variance of the mean of `n` samples (unbiased); 0 below two samples.
RELUME_HD inline float variance_of_mean(float m2, uint32_t n) {
  return n < 2 ? 0.0f : m2 / (static_cast<float>(n) * static_cast<float>(n - 1));
}

}  // namespace relume
