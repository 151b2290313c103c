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

/// The same for samples of frames of which `correlated` count as one: the sum of the correlations between a frame and
/// all others, at most `n`.
RELUME_HD inline float variance_of_mean(float m2, uint32_t n, uint32_t correlated) {
  return variance_of_mean(m2, n) * static_cast<float>(static_cast<int>(relume::min(n, correlated)));
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
