// adaptive.method "paper" ([Schalk18] §3.1, alg. 1, and alg. 2 with a reprojected history): noisy pixels get more
// samples until each pixel has a probability of further ones.
#pragma once

#include "core/hash.h"
#include "framebuffer/pixel_moments.h"

namespace relume {

/// Relative standard deviation of a pixel's samples, eq. 11 and 12.
RELUME_HD inline float adaptive_noise(const PixelMoments& history) {
  constexpr float kEpsilon = 1e-3f;
  const float channels = 3.0f * static_cast<float>(history.samples - 1);
  const float variance = history.samples > 1 ? history.m2_rgb / channels : 0.0f;
  return (std::sqrt(variance) + kEpsilon) / (luminance(history.mean) + kEpsilon);
}

/// Threshold τ of iteration `iteration`: 1 until `min_samples`, then linear to 0 at `max_samples` (erratum: the printed
/// algorithm assigns instead of subtracting).
RELUME_HD inline float adaptive_threshold(uint32_t iteration, uint32_t min_samples, uint32_t max_samples) {
  if (iteration <= min_samples) return 1.0f;
  if (iteration >= max_samples) return 0.0f;
  return 1.0f - static_cast<float>(iteration - min_samples) / static_cast<float>(max_samples - min_samples);
}

/// Decides for each pixel whether it gets a sample in this frame.
struct PaperAllocationKernel {
  MomentsView history;
  View<float> probability;     ///< probability of a sample once τ is 0; 0: not yet settled
  View<float> noise;           ///< noise by eq. 12
  View<uint32_t> allocation;   ///< 0 or 1
  uint32_t iteration = 0;      ///< frames since the last change
  bool scene_changed = false;  ///< whether lights or objects changed since the previous frame
  uint32_t min_samples = 4;
  uint32_t max_samples = 32;
  uint32_t seed = 0;
  uint32_t frame = 0;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const PixelMoments known = history[pixel];
    const uint32_t n = known.samples;
    noise[pixel] = adaptive_noise(known);
    if (scene_changed) probability[pixel] = 0.0f;  // settled for another image
    if (iteration == max_samples) probability[pixel] = known_probability(n);
    allocation[pixel] = ready(x, y, pixel, n) ? 1u : 0u;
  }

 private:
  RELUME_HD float known_probability(uint32_t n) const {
    const float least = static_cast<float>(min_samples) / static_cast<float>(max_samples);
    return clamp(static_cast<float>(n) / static_cast<float>(max_samples), least, 1.0f);
  }
  RELUME_HD bool ready(uint32_t x, uint32_t y, uint32_t pixel, uint32_t n) const {
    if (iteration >= max_samples) return drawn(x, y, probability[pixel]);
    if (n < min_samples) return true;
    const bool settled = probability[pixel] > 0.0f;
    // In continuous motion every frame is iteration 0, and pixels that waited would never get a sample.
    if (iteration == 0) return !settled || drawn(x, y, probability[pixel]);
    if (settled) return false;  // reprojected: other pixels need samples first
    return noise[pixel] >= adaptive_threshold(iteration, min_samples, max_samples);
  }
  RELUME_HD bool drawn(uint32_t x, uint32_t y, float share) const {
    constexpr uint32_t kSalt = 0x7ed55d16u;
    return to_unit_float(hash(hash(seed ^ kSalt, x, y), frame)) < share;
  }
};

}  // namespace relume
