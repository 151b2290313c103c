// The specular part of the history "reproject" by looking back. It is looked up where the image in a reflection was,
// while the rest of the mean moves with the surface.
#pragma once

#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// Before the mean moves: what remains in it is diffuse light and emission. The specular part finds its own place.
struct DetachSpecularKernel {
  BackwardReprojection reflections;
  View<const Rgb> specular_before;
  View<const uint32_t> samples_before;
  View<Rgb> specular;
  View<uint32_t> samples;
  View<Rgb> mean;            ///< of the frame before, in its places
  uint32_t max_samples = 1;  ///< that the past counts for at most

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * reflections.width + x;
    mean[pixel] -= specular_before[pixel];
    const BackwardTaps taps = reflections.taps(x, y);
    const uint32_t known = taps.least(samples_before);
    samples[pixel] = relume::min(known, max_samples);
    specular[pixel] = known > 0 ? taps.fetch(specular_before) : Rgb(0);
  }
};

/// After the rest of the mean has moved.
struct AttachSpecularKernel {
  View<const Rgb> specular;
  View<Rgb> mean;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    mean[pixel] += specular[pixel];
  }
};

/// After a sample has joined the mean: its specular part joins its own mean, and the difference that other counts make
/// is put into the whole. While nothing has moved, both counts are the same and the mean keeps its bits.
struct AccumulateSpecularKernel {
  View<const Rgb> radiance;         ///< of this frame's sample
  View<const Rgb> found;            ///< its specular part
  View<const Rgb> albedo;           ///< of specular lobes; black: they show no image
  View<const uint32_t> allocation;  ///< samples of the pixel in this frame, 0 or 1; empty: 1
  View<const uint32_t> samples;     ///< of the mean, this frame's included
  View<Rgb> specular;
  View<uint32_t> specular_samples;
  View<Rgb> mean;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (!allocation.empty() && allocation[pixel] == 0) return;
    Rgb value(0);
    if (max_component(albedo[pixel]) > 0.0f && is_finite(radiance[pixel]) && is_finite(found[pixel]))
      value = found[pixel];
    const uint32_t n = specular_samples[pixel] + 1;
    const Rgb before = specular[pixel];
    const Rgb after = before + (value - before) / static_cast<float>(n);
    if (n != samples[pixel]) mean[pixel] += after - before - (value - before) / static_cast<float>(samples[pixel]);
    specular[pixel] = after;
    specular_samples[pixel] = n;
  }
};

}  // namespace relume
