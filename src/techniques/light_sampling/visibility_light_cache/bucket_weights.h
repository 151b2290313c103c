// Probabilities of a region's buckets.
#pragma once

#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"
#include "techniques/spatial/octree/octree_tree.h"

namespace relume {

/// A fraction `even` is uniform ([Dittebrandt20, §4.2]); an empty bucket's part goes to the next non-empty one. The
/// rest is proportional to Σ Φ/d² over the bucket's lights (extension of the paper).
struct BucketWeightsKernel {
  OctreeView tree;
  View<const uint32_t> parents;
  View<const LightBuckets> buckets;
  View<const uint32_t> entries;
  View<const LightSummary> lights;
  uint32_t bucket_size = 32;
  float even = 1;                     ///< uniform share, > 0
  View<float> weights;                ///< by bucket; a region's first index is its first entry / bucket_size
  LightId first_infinite = kNoLight;  ///< lights from here on are at infinity
  float infinity2 = 1;                ///< squared distance that stands for infinity: of the scene's radius, m²
  View<const LightShares> shares;     ///< by region; empty: none

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const LightBuckets b = buckets[region];
    if (b.count == 0) return;
    float* out = weights.data + b.first / bucket_size;
    const float turn = even / static_cast<float>(b.count);
    const float sum = even < 1.0f ? power_over_squared_distance(region, b, out) : 0.0f;
    const float scale = sum > 0.0f && is_finite(sum) ? (1.0f - even) / sum : 0.0f;
    const float all_turns = scale > 0.0f ? turn : turn / even;
    uint32_t last = b.count - 1;
    while (is_empty(b, last)) --last;
    uint32_t waiting = b.count - 1 - last;  // turns of empty last buckets pass to the first
    for (uint32_t i = 0; i < b.count; ++i) {
      ++waiting;
      if (is_empty(b, i)) {
        out[i] = 0;
        continue;
      }
      out[i] = (scale > 0.0f ? scale * out[i] : 0.0f) + all_turns * static_cast<float>(waiting);
      waiting = 0;
    }
  }

 private:
  RELUME_HD bool is_empty(const LightBuckets& b, uint32_t bucket) const {
    return entries[b.first + bucket * bucket_size] == CachedLight::kNone;
  }

  RELUME_HD float visibility(uint32_t region, LightId id) const {
    if (region >= shares.size) return 1.0f;
    return shares[region].visibility.of[InfinityVisibility::index_of(id - first_infinite)];
  }

  /// Sums power over squared distance, W/m², per bucket; returns the total. Distances are at least half the region's
  /// diagonal. The power of lights at infinity is that through the scene's bounds.
  RELUME_HD float power_over_squared_distance(uint32_t region, const LightBuckets& b, float* out) const {
    const OctreeCell cell = octree_cell_of(tree.nodes, parents, region);
    const float half = 0.5f * static_cast<float>(cell.size());
    const Vec3 center = tree.corner + (Vec3(cell.corner) + Vec3(half)) / tree.scale;
    const float least = 3.0f * sqr(half / tree.scale);
    float sum = 0;
    for (uint32_t i = 0; i < b.count; ++i) {
      out[i] = 0;
      const uint32_t* entry = entries.data + b.first + i * bucket_size;
      for (uint32_t k = 0; k < bucket_size && entry[k] != CachedLight::kNone; ++k) {
        const LightId id = CachedLight::id(entry[k]);
        const LightSummary& light = lights[id];
        out[i] += id < first_infinite ? light.watts / max(length_squared(light.position - center), least)
                                      : visibility(region, id) * light.watts / infinity2;
      }
      sum += out[i];
    }
    return sum;
  }
};

}  // namespace relume
