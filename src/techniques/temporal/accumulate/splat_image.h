// An image of the splats of light paths, separate from the mean of the camera's samples: adaptive sampling skips
// pixels, but light paths reach them too.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Mean of the frames' splats, weighted by their numbers of light paths ([West79]).
struct SplatImage {
  View<const Rgb> splats;  ///< splats of this frame, scaled to estimate the radiance of light paths; empty: none
  View<Rgb> mean;
  View<float> m2;         ///< Σ weight · squared distance of luminance from its mean
  View<float> weight;     ///< light paths per pixel
  View<uint32_t> frames;  ///< frames with light paths
  float paths = 0;        ///< light paths per pixel in this frame

  RELUME_HD bool empty() const { return splats.empty(); }
  RELUME_HD Rgb splat(uint32_t pixel) const { return empty() ? Rgb(0) : splats[pixel]; }
  RELUME_HD Rgb mean_of(uint32_t pixel) const { return empty() ? Rgb(0) : mean[pixel]; }

  /// Removes all splats of earlier frames.
  RELUME_HD void reset(uint32_t pixel) const {
    if (empty()) return;
    mean[pixel] = Rgb(0);
    m2[pixel] = weight[pixel] = 0.0f;
    frames[pixel] = 0;
  }

  /// Adds this frame's splats.
  RELUME_HD void add(uint32_t pixel) const {
    if (empty() || !(paths > 0.0f)) return;
    const Rgb value = splats[pixel];
    const Rgb before = mean[pixel];
    const float sum = weight[pixel] + paths;
    const Rgb after = before + (value - before) * (paths / sum);
    m2[pixel] += paths * luminance(value - before) * luminance(value - after);
    mean[pixel] = after;
    weight[pixel] = sum;
    ++frames[pixel];
  }
};

/// Variance of the mean splat at a pixel; 0 below two frames.
RELUME_HD inline float splat_variance(float m2, float weight, uint32_t frames) {
  return frames < 2 ? 0.0f : m2 / (static_cast<float>(frames - 1) * weight);
}

}  // namespace relume
