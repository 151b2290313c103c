// Mean and variance of a pixel's samples, updated per sample ([Welford62]).
#pragma once

#include "core/vec.h"
#include "core/view.h"
#include "framebuffer/buffer_key.h"

namespace relume {

/// Unbiased variance of the mean of `n` samples, from their sum of squared deviations; 0 below two samples.
RELUME_HD inline float variance_of_mean(float m2, uint32_t n) {
  return n < 2 ? 0.0f : m2 / (static_cast<float>(n) * static_cast<float>(n - 1));
}

/// Factor on the variance of the mean of `n` samples that are correlated, over variance_of_mean() of their squared
/// deviations. The correlation of samples k frames apart is ρ^k, and the sum of these over all k, (1 + ρ) / (1 − ρ), is
/// `correlated`. The mean of n such samples has the variance σ² T / n, where T sums the correlations within n frames.
/// Deviations from their own mean add up to σ² (n − T), not σ² (n − 1), because the mean follows them.
RELUME_HD inline double correlation_factor(uint32_t n, uint32_t correlated) {
  if (n < 2 || correlated < 2) return 1;
  const auto count = static_cast<double>(n);
  const auto all = static_cast<double>(correlated);
  double power = 1;                           // ρ^n
  double square = (all - 1.0) / (all + 1.0);  // ρ^1, ρ^2, ρ^4, …
  for (uint32_t rest = n; rest != 0; rest >>= 1) {
    if ((rest & 1u) != 0) power *= square;
    square *= square;
  }
  const double within = all - 0.5 * (all * all - 1.0) * (1.0 - power) / count;
  return within * (count - 1.0) / (count - within);
}

/// Variance of the mean of samples of frames that depend on each other, as in Pass::correlated_frames().
RELUME_HD inline float variance_of_mean(float m2, uint32_t n, uint32_t correlated) {
  const float independent = variance_of_mean(m2, n);
  return correlated < 2 ? independent : independent * static_cast<float>(correlation_factor(n, correlated));
}

/// Moments of one pixel.
struct PixelMoments {
  Rgb mean{0};
  float m2 = 0;      ///< Σ (Y − mean Y)² of the samples' luminance Y
  float m2_rgb = 0;  ///< Σ over the samples and the three channels of (value − mean)²
  uint32_t samples = 0;

  /// Adds a sample.
  RELUME_HD void add(const Rgb& value) {
    const Rgb before = samples > 0 ? mean : Rgb(0);
    const uint32_t n = samples + 1;
    mean = before + (value - before) / static_cast<float>(n);
    const Rgb squares = (value - before) * (value - mean);
    m2 = samples > 0 ? m2 + luminance(value - before) * luminance(value - mean) : 0.0f;
    m2_rgb = samples > 0 ? m2_rgb + (squares.x + squares.y + squares.z) : 0.0f;
    samples = n;
  }

  /// Limits the sample count to `most`, so that later samples have more weight. Keeps the mean and the variance per
  /// sample.
  RELUME_HD void limit(uint32_t most) {
    if (samples <= most) return;
    const float scale = static_cast<float>(relume::max(most, 1u) - 1) / static_cast<float>(samples - 1);
    m2 *= scale;
    m2_rgb *= scale;
    samples = most;
  }
};

/// Buffers of a PixelMoments per pixel, with one plane per member, because most readers need a single member.
struct MomentBuffers {
  BufferKey<Rgb> mean;
  BufferKey<float> m2;
  BufferKey<float> m2_rgb;  ///< exists only if a pass reads it
  BufferKey<uint32_t> samples;
};

/// Read access to the planes of pixel moments.
struct MomentsView {
  View<const Rgb> mean;
  View<const float> m2;
  View<const float> m2_rgb;  ///< may be empty
  View<const uint32_t> samples;

  RELUME_HD PixelMoments operator[](uint32_t pixel) const {
    return {mean[pixel], m2[pixel], m2_rgb.empty() ? 0.0f : m2_rgb[pixel], samples[pixel]};
  }
};

/// Write access to the planes of pixel moments.
struct MutableMomentsView {
  View<Rgb> mean;
  View<float> m2;
  View<float> m2_rgb;  ///< may be empty
  View<uint32_t> samples;

  RELUME_HD void store(uint32_t pixel, const PixelMoments& moments) const {
    mean[pixel] = moments.mean;
    m2[pixel] = moments.m2;
    if (!m2_rgb.empty()) m2_rgb[pixel] = moments.m2_rgb;
    samples[pixel] = moments.samples;
  }
  RELUME_HD operator MomentsView() const {  // NOLINT(google-explicit-constructor): the same arrays
    return {{mean.data, mean.size}, {m2.data, m2.size}, {m2_rgb.data, m2_rgb.size}, {samples.data, samples.size}};
  }
};

}  // namespace relume
