// Pilot samples: those that decide how many samples a pixel gets do not enter the image ([Kirk91]).
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Removes all samples from the image, which is unbiased from then on, as no further sample decides anything.
struct ForgetPilotKernel {
  View<Rgb> mean;
  View<float> m2;
  View<Rgb> m2_rgb;  ///< may be empty
  View<uint32_t> samples;
  View<Rgb> light_mean;  ///< of light paths (LightFilm); may be empty, as the next two
  View<float> light_m2;
  View<float> light_paths;
  View<uint32_t> light_frames;
  View<uint32_t> allocation;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    mean[pixel] = Rgb(0);
    if (!m2_rgb.empty()) m2_rgb[pixel] = Rgb(0);
    m2[pixel] = 0.0f;
    samples[pixel] = 0;
    if (!light_mean.empty()) {
      light_mean[pixel] = Rgb(0);
      light_m2[pixel] = light_paths[pixel] = 0.0f;
      light_frames[pixel] = 0;
    }
    allocation[pixel] = 1;  // none is left without a sample
  }
};

}  // namespace relume
