// Adds each frame's sample to the exact sums of its pixel.
#pragma once

#include "core/view.h"
#include "framebuffer/pixel_sums.h"

namespace relume {

struct SampleSumsKernel {
  View<const Rgb> radiance;  ///< of this frame's sample; counts as black if it is not finite
  View<SampleBlock> block;   ///< the samples since the last complete block
  View<RadianceSums> sums;   ///< all complete blocks
  bool ends_block = false;   ///< whether this sample is the last of its block
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb value = radiance[pixel];
    SampleBlock sum = block[pixel];
    sum.add(is_finite(value) ? value : Rgb(0));
    if (ends_block) {
      sums[pixel].add(sum);
      sum = {};
    }
    block[pixel] = sum;
  }
};

/// The same for properties of first hits, whose sums need no blocks.
struct SurfaceSumsKernel {
  View<const Rgb> albedo;
  View<const Vec3> normal;
  View<const float> depth;
  View<SurfaceSums> sums;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    sums[pixel].add(albedo[pixel], normal[pixel], depth[pixel]);
  }
};

}  // namespace relume
