// What regions know, as pictures show it.
#pragma once

#include "techniques/octree/sample_stream.h"
#include "techniques/visibility_light_cache/visibility_light_cache.h"

namespace relume {

/// How many lights the cache knew at each pixel's first hit, to be looked at.
struct KnownLightsKernel {
  View<const VertexSample> samples;
  View<const LightBuckets> buckets;
  View<const uint32_t> entries;
  uint32_t bucket_size = 0;
  View<uint32_t> known;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const uint32_t region = samples[pixel].region;
    known[pixel] = 0;
    if (region >= buckets.size) return;
    const uint32_t size = buckets[region].count * bucket_size;
    for (uint32_t i = 0; i < size; ++i) {
      if (entries[buckets[region].first + i] != CachedLight::kNone) ++known[pixel];
    }
  }
};

}  // namespace relume
