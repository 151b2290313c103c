// The history "accumulate": sums over all frames since the last change, for the mean and its variance.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

struct AccumulateKernel {
  View<const Rgb> radiance;   ///< of this frame's sample
  View<const uint32_t> rays;  ///< of this frame's sample
  View<Rgb> sum;
  View<float> luminance_squared;  ///< sum of squares
  View<uint32_t> ray_sum;
  View<uint32_t> nonfinite;  ///< counts samples that were not finite and are taken as black
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb value = radiance[pixel];
    ray_sum[pixel] += rays[pixel];
    if (!is_finite(value)) {
      ++nonfinite[pixel];
      return;
    }
    sum[pixel] += value;
    luminance_squared[pixel] += sqr(luminance(value));
  }
};

/// Variance of the mean luminance of `n` samples with these sums (unbiased); 0 below two samples.
RELUME_HD inline float variance_of_mean(const Rgb& sum, float luminance_squared, uint32_t n) {
  if (n < 2) return 0.0f;
  const float count = static_cast<float>(n);
  const float mean = luminance(sum) / count;
  return relume::max(0.0f, luminance_squared / count - mean * mean) / (count - 1.0f);
}

}  // namespace relume
