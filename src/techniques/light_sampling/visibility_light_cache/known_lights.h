// Kernels of the layer `known-lights`.
#pragma once

#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

struct CountKnownLightsKernel {
  View<const LightBuckets> buckets;
  View<const uint32_t> entries;
  uint32_t bucket_size = 0;
  View<uint32_t> known;

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t size = buckets[region].count * bucket_size;
    known[region] = 0;
    for (uint32_t i = 0; i < size; ++i) {
      if (entries[buckets[region].first + i] != CachedLight::kNone) ++known[region];
    }
  }
};

/// Writes the number of cached lights at each pixel's first hit.
struct KnownLightsKernel {
  View<const VertexSample> samples;
  View<const uint32_t> known;  ///< by region
  View<uint32_t> pixels;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const uint32_t region = samples[pixel].region;
    pixels[pixel] = region < known.size ? known[region] : 0;
  }
};

}  // namespace relume
