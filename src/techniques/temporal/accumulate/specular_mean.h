// A part of the mean that reprojection does not move with the rest. Backward reprojection moves the specular part with
// the images in reflections. Forward reprojection of a radiance cache looks up the light of cells again.
#pragma once

#include "framebuffer/pixel_moments.h"

namespace relume {

/// Each part has a separate sample count. While nothing moves, the counts are equal and the mean keeps its bits.
struct SpecularMean {
  View<const Rgb> radiance;  ///< this part of this frame's sample
  View<const Rgb> albedo;    ///< albedo of specular lobes; black: the sample lacks the part. Empty: all samples have it
  View<const Rgb> history;   ///< mean of this part of earlier samples
  View<const uint32_t> history_samples;
  View<Rgb> mean;  ///< empty: the parts are not kept apart
  View<uint32_t> samples;

  RELUME_HD bool empty() const { return mean.empty(); }

  /// Keeps the history of a pixel without a sample in this frame.
  RELUME_HD void keep(uint32_t pixel) const {
    if (empty()) return;
    mean[pixel] = history[pixel];
    samples[pixel] = history_samples[pixel];
  }

  /// Adds this frame's sample, whose radiance `total` has already joined `moments`. Where the counts differ, corrects
  /// `moments` for the separate count of this part. `keep_history`: false replaces all earlier samples.
  RELUME_HD void add(uint32_t pixel, const Rgb& total, bool keep_history, PixelMoments& moments) const {
    const bool has_part = albedo.empty() || max_component(albedo[pixel]) > 0.0f;
    const Rgb value = has_part && is_finite(total) && is_finite(radiance[pixel]) ? radiance[pixel] : Rgb(0);
    const uint32_t n = (keep_history ? history_samples[pixel] : 0u) + 1;
    const Rgb before = keep_history ? history[pixel] : Rgb(0);
    const Rgb after = before + (value - before) / static_cast<float>(n);
    if (n != moments.samples) moments.mean += after - before - (value - before) / static_cast<float>(moments.samples);
    mean[pixel] = after;
    samples[pixel] = n;
  }
};

}  // namespace relume
