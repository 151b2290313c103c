// Makes the caches of all regions from the samples of the last frame ([Dittebrandt20, §4.1]): deduplicate, merge with
// the neighbours, sort into as few buckets as hold everything.
#pragma once

#include <iosfwd>
#include <vector>

#include "frame/launch.h"
#include "techniques/light_sampling/visibility_light_cache/bucket_weights.h"
#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"
#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Buckets of a region, at most.
inline constexpr uint32_t kMaxBuckets = 64;
/// Different lights that one region may learn from one frame's samples; more are dropped and counted.
inline constexpr uint32_t kMaxSeenLights = 1024;

struct CacheBuildOptions {
  uint32_t bucket_size = 32;    ///< lights a bucket holds, at most kMaxBucketSize
  uint32_t max_samples = 4096;  ///< looked at in each region, spread evenly over what there is
  float hysteresis = 0.75f;     ///< share of a bucket that must suffice before there are fewer of them than before
  uint32_t memory = 0;          ///< frames for which lights are remembered that were not seen again; 0: none
  float even_buckets = 0.1f;    ///< share of the choice among buckets that is even
};

/// What one region knows, before it is sorted into buckets.
struct LightList {
  uint32_t first = 0;
  uint32_t count = 0;
};

/// Caches by leaf slot.
class LightCaches {
 public:
  /// Replaces the caches of the leaves of `tree` by what `samples` saw of `lights`, which are all finite ones; those
  /// with larger ids are at infinity, or gone since.
  void build(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples, View<const LightGuess> lights,
             const CacheBuildOptions& options);

  /// Leaves of `next` take on the caches of the leaves that they stem from.
  void populate(Backend& backend, const OctreeTree& next);

  View<const LightBuckets> buckets() const { return view_of(buckets_); }
  View<const uint32_t> entries() const { return view_of(entries_); }
  /// By bucket: those of a region begin at its first entry over the bucket size, and sum to one.
  View<const float> bucket_weights() const { return view_of(bucket_weights_); }
  /// Known lights of a region, sorted by id (CachedLight).
  View<const uint32_t> list(uint32_t region) const {
    return {lights_.data() + lists_[region].first, lists_[region].count};
  }
  /// Lights for which there was no room in the last build.
  uint64_t dropped() const { return dropped_; }
  /// Of what each leaf slot has, and of the lights that they know.
  size_t region_bytes() const;
  size_t entry_bytes() const;
  size_t memory_bytes() const { return region_bytes() + entry_bytes(); }

  /// Whether every bucket holds `bucket_size` of `light_count` lights and is chosen only if it is not empty: a
  /// checkpoint may be damaged.
  bool consistent(uint32_t bucket_size, uint32_t light_count) const;
  void save(std::ostream& out) const;
  /// Sets the stream's failbit if it is short or makes no sense.
  void load(std::istream& in);

 private:
  /// From the lists that were just made.
  void fill_buckets(Backend& backend, const OctreeTree& tree, View<const LightGuess> lights,
                    const CacheBuildOptions& options, std::vector<uint64_t>& dropped);

  std::vector<LightBuckets> buckets_;  ///< by leaf slot
  std::vector<LightList> lists_;       ///< by leaf slot
  std::vector<uint32_t> entries_;
  std::vector<float> bucket_weights_;
  std::vector<uint32_t> lights_;
  uint64_t dropped_ = 0;
};

/// Distinct visible lights of each region, sorted, into the places of the region's samples.
struct DeduplicateLightsKernel {
  SampleGroupsView samples;
  uint32_t light_count = 0;  ///< others are left out
  uint32_t max_samples = 0;
  View<uint32_t> seen;     ///< parallel to samples.order
  View<uint32_t> counts;   ///< by region
  View<uint64_t> dropped;  ///< one

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
};

/// Merges a region's lights with those of its neighbours and with what it remembers.
struct MergeLightsKernel {
  SampleGroupsView samples;
  View<const uint32_t> seen;
  View<const uint32_t> seen_counts;
  View<const uint32_t> neighbours;
  View<const LightList> old_lists;
  View<const uint32_t> old_lights;
  uint32_t light_count = 0;
  uint32_t memory = 0;
  View<const uint32_t> places;  ///< by region, into `lights`
  View<uint32_t> lights;
  View<LightList> lists;

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
  /// Upper bound of a merged list.
  RELUME_HD uint32_t bound(uint32_t region) const;
};

/// Number of buckets of each region, merged bottom up as long as they hold everything.
struct CountBucketsKernel {
  View<const LightList> lists;
  View<const uint32_t> lights;
  View<const LightBuckets> old_buckets;
  uint32_t bucket_size = 32;
  float hysteresis = 0.75f;
  View<LightBuckets> buckets;

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
};

/// Sorts lists into buckets; `light mod buckets` is the bucket.
struct FillBucketsKernel {
  View<const LightList> lists;
  View<const uint32_t> lights;
  View<const LightBuckets> buckets;
  uint32_t bucket_size = 32;
  View<uint32_t> entries;
  View<uint64_t> dropped;  ///< one

  RELUME_HD void operator()(uint32_t region, uint32_t) const;
};

}  // namespace relume

#include "techniques/light_sampling/visibility_light_cache/build_cache_impl.h"
