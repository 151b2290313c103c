// Moments of the caustic layer, a part of the image that denoisers filter separately.
#pragma once

#include "framebuffer/pixel_moments.h"

namespace relume {

/// Splats of light paths at a pixel, from SplatImage; all black without a splat image.
struct PixelSplats {
  Rgb now{0};     ///< of this frame
  Rgb before{0};  ///< mean over the earlier frames
  Rgb after{0};   ///< mean with this frame
};

struct CausticMoments {
  View<const Rgb> radiance;    ///< the layer's part of this frame's radiance; empty: no layer
  MutableMomentsView moments;  ///< of the samples that the pixel keeps, which this frame's sample joins

  RELUME_HD bool empty() const { return radiance.empty(); }

  /// Adds this frame. `keep`: false replaces all earlier samples. `sampled`: whether the pixel has a sample. `finite`:
  /// whether its whole radiance is finite; otherwise it counts as black, as in the mean. As there, the splat image is
  /// added to the mean of the samples without their splats.
  RELUME_HD void add(uint32_t pixel, bool keep, bool sampled, bool finite, const PixelSplats& splats) const {
    PixelMoments layer = keep ? MomentsView(moments)[pixel] : PixelMoments{};
    if (sampled) {
      layer.mean -= splats.before;
      layer.add(finite ? radiance[pixel] - splats.now : Rgb(0));
      layer.mean += splats.after;
    } else {
      layer.mean += splats.after - splats.before;
    }
    moments.store(pixel, layer);
  }
};

}  // namespace relume
