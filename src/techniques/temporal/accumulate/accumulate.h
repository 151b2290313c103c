// Adds each frame's sample to the moments of its pixel.
#pragma once

#include "framebuffer/pixel_moments.h"
#include "techniques/temporal/accumulate/light_film.h"
#include "techniques/temporal/accumulate/specular_mean.h"

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
  LightFilm film;            ///< splats of light paths, which `radiance` and the mean contain
  SpecularMean specular;     ///< the specular part of the mean
  bool keep = true;          ///< false: this frame's sample replaces all earlier ones
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    ray_sum[pixel] += rays[pixel];
    if (!keep) film.reset(pixel);
    PixelMoments pixel_moments = keep ? history[pixel] : PixelMoments{};
    const Rgb film_before = film.mean_of(pixel);
    film.add(pixel);
    const Rgb film_after = film.mean_of(pixel);
    if (!allocation.empty() && allocation[pixel] == 0) {
      if (!film.empty()) pixel_moments.mean += film_after - film_before;
      specular.keep(pixel);
    } else {
      if (!taken.empty()) ++taken[pixel];
      if (!film.empty()) pixel_moments.mean -= film_before;
      pixel_moments.add(sample(pixel));
      if (!film.empty()) pixel_moments.mean += film_after;
      if (!specular.empty()) specular.add(pixel, radiance[pixel], keep, pixel_moments);
    }
    moments.store(pixel, pixel_moments);
  }

 private:
  /// This frame's sample without the splats of light paths.
  RELUME_HD Rgb sample(uint32_t pixel) const {
    const Rgb value = film.empty() ? radiance[pixel] : radiance[pixel] - film.splat(pixel);
    if (is_finite(value)) return value;
    ++nonfinite[pixel];
    return Rgb(0);
  }
};

}  // namespace relume
