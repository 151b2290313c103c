// Builds the caches of all regions from last frame's samples ([Dittebrandt20, §4.1]): deduplicates lights, merges those
// of neighbours, and sorts them into the fewest buckets.
#pragma once

#include <iosfwd>
#include <span>

#include "core/array.h"
#include "frame/launch.h"
#include "frame/primitives/primitive.h"
#include "techniques/light_sampling/visibility_light_cache/bucket_weights.h"
#include "techniques/light_sampling/visibility_light_cache/light_set.h"
#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"
#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Maximum number of buckets per region.
inline constexpr uint32_t kMaxBuckets = 64;

/// How regions learn the share of samples that explore.
struct LearnedExploration {
  bool learns = false;
  float start = 0.1f;  ///< share before a region has samples
  float floor = 0.02f;
};

struct CacheBuildOptions {
  uint32_t bucket_size = 32;          ///< capacity in lights, at most kMaxBucketSize
  uint32_t max_samples = 4096;        ///< maximum number read per region, spread evenly over its samples
  float hysteresis = 0.75f;           ///< maximum fill of each bucket, as a fraction, after their number shrinks
  uint32_t memory = 0;                ///< frames that a light stays listed without being seen
  float even_buckets = 0.1f;          ///< probability of choosing a bucket uniformly
  LightId first_infinite = kNoLight;  ///< listed lights from here on are at infinity
  float scene_radius = 1;             ///< metres
  LearnedExploration exploration = {};
};

/// Lights of one region, before sorting into buckets.
struct LightList {
  uint32_t first = 0;
  uint32_t count = 0;
};

/// Temporary memory for LightCaches, which callers keep between frames.
struct CacheScratch {
  explicit CacheScratch(Memory& memory = host_memory())
      : seen(memory),
        seen_counts(memory),
        offsets(memory),
        lights(memory),
        lists(memory),
        buckets(memory),
        entries(memory),
        bucket_weights(memory),
        shares(memory),
        dropped(memory) {}

  Array<uint32_t> seen;         ///< distinct lights, parallel to SampleGroupsView::order
  Array<uint32_t> seen_counts;  ///< by leaf slot
  Array<uint32_t> offsets;      ///< offset of the first list element, later of the first bucket, by leaf slot
  Array<uint32_t> lights;       ///< list elements of the next caches
  Array<LightList> lists;       ///< lists of the next caches, by leaf slot
  Array<LightBuckets> buckets;  ///< buckets of the next caches, by leaf slot
  Array<uint32_t> entries;      ///< of the next caches
  Array<float> bucket_weights;  ///< of the next caches
  Array<LightShares> shares;    ///< of the next caches, by leaf slot
  KernelValue<uint64_t> dropped;
  PrimitiveScratch primitives;

  size_t memory_bytes() const {
    return seen.memory_bytes() + seen_counts.memory_bytes() + offsets.memory_bytes() + lights.memory_bytes() +
           lists.memory_bytes() + buckets.memory_bytes() + entries.memory_bytes() + bucket_weights.memory_bytes() +
           shares.memory_bytes() + primitives.memory_bytes();
  }
};

/// Caches by leaf slot.
class LightCaches {
 public:
  explicit LightCaches(Memory& memory = host_memory())
      : buckets_(memory), lists_(memory), entries_(memory), bucket_weights_(memory), lights_(memory), shares_(memory) {}

  /// Rebuilds the caches of the leaves of `tree` from `samples`. `lights` are all lights that regions may list: the
  /// finite ones, or all. Larger ids are ignored, as those of removed lights.
  void build(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples, View<const LightSummary> lights,
             const CacheBuildOptions& options, CacheScratch& scratch);
  void build(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples, View<const LightSummary> lights,
             const CacheBuildOptions& options) {
    CacheScratch scratch(lists_.memory());
    build(backend, tree, samples, lights, options, scratch);
  }

  /// Gives each leaf of `next` the cache of the leaf that it stems from.
  void populate(Backend& backend, const OctreeTree& next, CacheScratch& scratch);
  void populate(Backend& backend, const OctreeTree& next) {
    CacheScratch scratch(lists_.memory());
    populate(backend, next, scratch);
  }

  LightCaches copy(Backend& backend) const;
  /// Removes all caches.
  void clear();

  View<const LightBuckets> buckets() const { return buckets_.view(); }
  View<const uint32_t> entries() const { return entries_.view(); }
  /// Probability of each bucket. Those of a region begin at index (first entry / bucket size) and sum to one.
  View<const float> bucket_weights() const { return bucket_weights_.view(); }
  /// By region; empty unless regions list lights at infinity or learn how much to explore.
  View<const LightShares> shares() const { return shares_.view(); }
  /// Buckets of all regions, for host code.
  std::span<const LightBuckets> read_buckets() const { return buckets_.read(); }
  /// Lights of a region as CachedLight, sorted by id, for host code.
  View<const uint32_t> list(uint32_t region) const {
    const LightList list = lists_.read()[region];
    return {lights_.read().data() + list.first, list.count};
  }
  /// Insertions that failed in the last build, for lack of room.
  uint64_t dropped() const { return dropped_; }
  /// Bytes of the data by leaf slot, and of lists, entries and weights.
  size_t region_bytes() const;
  size_t entry_bytes() const;
  size_t memory_bytes() const {
    return buckets_.memory_bytes() + lists_.memory_bytes() + entries_.memory_bytes() + lights_.memory_bytes() +
           bucket_weights_.memory_bytes() + shares_.memory_bytes();
  }

  /// Whether ids are below `light_count`, and probabilities sum to one without empty buckets. Detects damaged
  /// checkpoints.
  bool consistent(uint32_t bucket_size, uint32_t light_count) const;
  void save(std::ostream& out) const;
  /// Sets failbit and clears the caches if the data is truncated or invalid.
  void load(std::istream& in);

 private:
  /// Writes the next shares to `scratch`, none if nothing is learned.
  void learn_shares(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples, uint32_t light_count,
                    const CacheBuildOptions& options, CacheScratch& scratch) const;
  /// Sorts the new lists, in `scratch`, into buckets and computes the weights.
  void fill_buckets(Backend& backend, const OctreeTree& tree, View<const LightSummary> lights,
                    const CacheBuildOptions& options, CacheScratch& scratch);

  Array<LightBuckets> buckets_;  ///< by leaf slot
  Array<LightList> lists_;       ///< by leaf slot
  Array<uint32_t> entries_;
  Array<float> bucket_weights_;
  Array<uint32_t> lights_;
  Array<LightShares> shares_;  ///< by leaf slot, or empty
  uint64_t dropped_ = 0;
};

/// Writes each region's distinct visible lights, sorted, to its range of `seen`; one group per region.
struct DeduplicateLightsKernel {
  static constexpr uint32_t kThreads = 128;
  struct Shared {
    light_cache::LightSet set;
    uint32_t batch[kThreads];  ///< lights of the next samples
    uint32_t lights[kMaxSeenLights];
    uint32_t written;  ///< size of `lights`
    uint32_t lost;     ///< insertions into the full set
  };

  SampleGroupsView samples;
  uint32_t light_count = 0;  ///< ids from this one on are ignored
  uint32_t max_samples = 0;
  View<uint32_t> seen;     ///< parallel to samples.order
  View<uint32_t> counts;   ///< by region
  View<uint64_t> dropped;  ///< one counter

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t region, uint32_t) const;
  void on_host(uint32_t region, uint32_t) const;

 private:
  /// Light of sample i of `read`, which are spread evenly over the region's samples; LightSet::kFree if it is to be
  /// ignored.
  RELUME_HD uint32_t visible_light(uint32_t region, uint32_t i, uint32_t read) const;
  RELUME_HD void finish(uint32_t region, uint32_t written, uint32_t lost) const {
    counts[region] = written;
    if (lost > 0) atomic_add(&dropped[0], uint64_t{lost});
  }
};

/// Merges a region's lights with those of its face neighbours and its old list. One thread per region is enough: it
/// reads each of at most seven lists of kMaxSeenLights lights and the old list once, and keeps nothing but positions.
struct MergeLightsKernel {
  SampleGroupsView samples;
  View<const uint32_t> seen;
  View<const uint32_t> seen_counts;
  View<const uint32_t> neighbours;
  View<const LightList> old_lists;
  View<const uint32_t> old_lights;
  uint32_t light_count = 0;
  uint32_t memory = 0;
  View<const uint32_t> offsets;  ///< by region: first index in `lights`
  View<uint32_t> lights;
  View<LightList> lists;

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
  /// Upper bound of the length of a merged list.
  RELUME_HD uint32_t bound(uint32_t region) const;
};

/// Upper bounds of the lengths of merged lists, by region.
struct MergeBounds {
  MergeLightsKernel merge;

  RELUME_HD uint32_t operator()(size_t region) const { return merge.bound(static_cast<uint32_t>(region)); }
};

/// Number of buckets, by region.
struct BucketCounts {
  View<const LightBuckets> buckets;

  RELUME_HD uint32_t operator()(size_t region) const { return buckets.data[region].count; }
};

/// Sets the first entry of each region.
struct SetBucketOffsetsKernel {
  View<const uint32_t> offsets;  ///< number of buckets of earlier regions, by region
  uint32_t bucket_size = 32;
  View<LightBuckets> buckets;

  RELUME_HD void operator()(uint32_t region, uint32_t) const { buckets[region].first = offsets[region] * bucket_size; }
};

/// Copies the cache of each region's origin.
struct InheritCachesKernel {
  View<const uint32_t> previous;  ///< origin by region
  View<const LightBuckets> old_buckets;
  View<const LightList> old_lists;
  View<LightBuckets> buckets;
  View<LightList> lists;

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t from = previous[region];
    const bool known = from < old_buckets.size;
    buckets[region] = known ? old_buckets[from] : LightBuckets{};
    lists[region] = known ? old_lists[from] : LightList{};
  }
};

/// Halves the number of buckets of each region while all lights fit.
struct CountBucketsKernel {
  View<const LightList> lists;
  View<const uint32_t> lights;
  View<const LightBuckets> old_buckets;
  uint32_t bucket_size = 32;
  float hysteresis = 0.75f;
  View<LightBuckets> buckets;

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
};

/// Sorts lists into buckets: light i into bucket i mod count.
struct FillBucketsKernel {
  View<const LightList> lists;
  View<const uint32_t> lights;
  View<const LightBuckets> buckets;
  uint32_t bucket_size = 32;
  View<uint32_t> entries;
  View<uint64_t> dropped;  ///< one counter

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
};

}  // namespace relume

#include "techniques/light_sampling/visibility_light_cache/build_cache_impl.h"
