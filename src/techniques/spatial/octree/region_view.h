// Layers that show the octree.
#pragma once

#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Writes number and depth of the leaf at each pixel's first hit; 0 without a hit.
struct RegionViewKernel {
  View<const VertexSample> samples;
  View<const uint8_t> depths;
  View<uint32_t> regions;
  View<uint32_t> levels;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const uint32_t region = samples[pixel].region;
    regions[pixel] = region == kNoRegion ? 0 : region;
    levels[pixel] = region == kNoRegion ? 0 : depths[region];
  }
};

}  // namespace relume
