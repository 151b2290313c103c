// A film for what light paths bring, beside the mean of the camera's samples: adaptive allocation skips pixels, but
// light paths reach those too.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Mean of the frames' splats, weighted by the number of light paths behind them ([West79]).
struct LightFilm {
  View<const Rgb> splats;  ///< of this frame, as the radiance that all of its light paths estimate; empty: no film
  View<Rgb> mean;
  View<float> m2;         ///< Σ weight · squared distance of luminance from its mean
  View<float> weight;     ///< light paths a pixel
  View<uint32_t> frames;  ///< that brought any
  float paths = 0;        ///< light paths a pixel of this frame

  RELUME_HD bool empty() const { return splats.empty(); }
  RELUME_HD Rgb splat(uint32_t pixel) const { return empty() ? Rgb(0) : splats[pixel]; }
  RELUME_HD Rgb mean_of(uint32_t pixel) const { return empty() ? Rgb(0) : mean[pixel]; }

  /// Removes all splats of earlier frames.
  RELUME_HD void forget(uint32_t pixel) const {
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

/// Variance of the film's mean at a pixel; 0 below two frames.
RELUME_HD inline float film_variance(float m2, float weight, uint32_t frames) {
  return frames < 2 ? 0.0f : m2 / (static_cast<float>(frames - 1) * weight);
}

}  // namespace relume
