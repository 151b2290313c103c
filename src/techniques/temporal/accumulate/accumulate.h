// Adds each frame's sample to the moments of its pixel.
#pragma once

#include "framebuffer/pixel_moments.h"
#include "techniques/temporal/accumulate/caustic_moments.h"
#include "techniques/temporal/accumulate/specular_mean.h"
#include "techniques/temporal/accumulate/splat_image.h"

namespace relume {

struct AccumulateKernel {
  View<const Rgb> radiance;         ///< of this frame's sample
  View<const uint32_t> rays;        ///< rays traced for this frame's sample
  View<const uint32_t> allocation;  ///< samples of the pixel in this frame, 0 or 1; empty: 1 everywhere
  MomentsView history;              ///< moments of the earlier samples that the pixel keeps
  MutableMomentsView moments;       ///< moments with this frame's sample; may be the buffers of `history`
  View<uint32_t> taken;             ///< elements of its sequence that the pixel has used; may be empty
  View<uint32_t> ray_sum;
  View<uint32_t> nonfinite;  ///< count of samples that were not finite, which count as black
  SplatImage splat_image;    ///< splats of light paths, which `radiance` and the mean contain
  SpecularMean specular;     ///< the specular part of the mean, or the part from cells
  CausticMoments caustics;   ///< the caustic layer, which `radiance` and the mean contain
  bool keep = true;          ///< false: this frame's sample replaces all earlier ones
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    ray_sum[pixel] += rays[pixel];
    if (!keep) splat_image.reset(pixel);
    PixelMoments pixel_moments = keep ? history[pixel] : PixelMoments{};
    const Rgb splats_before = splat_image.mean_of(pixel);
    splat_image.add(pixel);
    const Rgb splats_after = splat_image.mean_of(pixel);
    const bool sampled = allocation.empty() || allocation[pixel] != 0;
    if (!sampled) {
      if (!splat_image.empty()) pixel_moments.mean += splats_after - splats_before;
      specular.keep(pixel);
    } else {
      if (!taken.empty()) ++taken[pixel];
      if (!splat_image.empty()) pixel_moments.mean -= splats_before;
      pixel_moments.add(sample(pixel));
      if (!splat_image.empty()) pixel_moments.mean += splats_after;
      if (!specular.empty()) specular.add(pixel, radiance[pixel], keep, pixel_moments);
    }
    moments.store(pixel, pixel_moments);
    if (!caustics.empty()) {
      caustics.add(pixel, keep, sampled, is_finite(radiance[pixel]),
                   {splat_image.splat(pixel), splats_before, splats_after});
    }
  }

 private:
  /// This frame's sample without the splats of light paths.
  RELUME_HD Rgb sample(uint32_t pixel) const {
    const Rgb value = splat_image.empty() ? radiance[pixel] : radiance[pixel] - splat_image.splat(pixel);
    if (is_finite(value)) return value;
    ++nonfinite[pixel];
    return Rgb(0);
  }
};

}  // namespace relume
