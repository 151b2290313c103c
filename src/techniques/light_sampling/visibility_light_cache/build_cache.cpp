#include "techniques/light_sampling/visibility_light_cache/build_cache.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/scan.h"
#include "techniques/light_sampling/visibility_light_cache/learn_shares.h"

namespace relume {
namespace {

/// Maximum total length of lists: positions have 32 bits.
constexpr uint64_t kMostListed = uint64_t{1} << 31;

/// Number of regions per tile of kernels that only copy.
constexpr uint32_t kRegionsPerTile = 1024;

}  // namespace

void LightCaches::build(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples,
                        View<const LightSummary> lights, const CacheBuildOptions& options, CacheScratch& scratch) {
  const uint32_t regions = tree.leaf_slots();
  scratch.dropped.write() = 0;
  scratch.seen.reset(samples.order.size, kUninitialized);
  scratch.seen_counts.reset(regions, kUninitialized);
  const DeduplicateLightsKernel deduplicate{samples,
                                            lights.size,
                                            options.max_samples,
                                            scratch.seen.mutable_view(),
                                            scratch.seen_counts.mutable_view(),
                                            scratch.dropped.mutable_view()};
  launch(backend, "vlc.deduplicate", deduplicate, regions, 1);

  MergeLightsKernel merge;
  merge.samples = samples;
  merge.seen = scratch.seen.view();
  merge.seen_counts = scratch.seen_counts.view();
  merge.neighbours = tree.links().neighbours.view();
  merge.old_lists = lists_.view();
  merge.old_lights = lights_.view();
  merge.light_count = lights.size;
  merge.memory = options.memory;
  scratch.offsets.reset(regions, kUninitialized);
  const uint64_t max_listed =
      exclusive_scan({backend, "vlc.merge", scratch.primitives}, MergeBounds{merge}, scratch.offsets.mutable_view());
  scratch.lists.reset(regions, kUninitialized);
  scratch.lights.reset(max_listed, kUninitialized);
  fill(backend, "vlc.merge", scratch.lights.mutable_view(), 0u);  // checkpoints include the gaps between lists
  merge.offsets = scratch.offsets.view();
  merge.lights = scratch.lights.mutable_view();
  merge.lists = scratch.lists.mutable_view();
  launch(backend, "vlc.merge", merge, regions, 1);

  learn_shares(backend, tree, samples, lights.size, options, scratch);
  fill_buckets(backend, tree, lights, options, scratch);
  dropped_ = scratch.dropped.read();
  // Nothing allocates from here on: all arrays change together, or none.
  lists_.swap(scratch.lists);
  lights_.swap(scratch.lights);
  buckets_.swap(scratch.buckets);
  entries_.swap(scratch.entries);
  bucket_weights_.swap(scratch.bucket_weights);
  shares_.swap(scratch.shares);
}

void LightCaches::learn_shares(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples,
                               uint32_t light_count, const CacheBuildOptions& options, CacheScratch& scratch) const {
  const uint32_t regions = tree.leaf_slots();
  if (options.first_infinite == kNoLight && !options.exploration.learns) return scratch.shares.clear();
  scratch.shares.reset(regions, kUninitialized);
  const View<const LightShares> old = shares_.size() == regions ? shares_.view() : View<const LightShares>{};
  const LearnSharesKernel learn{
      samples,       options.first_infinite, light_count, options.max_samples,          options.exploration,
      lists_.view(), lights_.view(),         old,         scratch.shares.mutable_view()};
  launch(backend, "vlc.shares", learn, regions, 1);
}

void LightCaches::fill_buckets(Backend& backend, const OctreeTree& tree, View<const LightSummary> lights,
                               const CacheBuildOptions& options, CacheScratch& scratch) {
  const auto regions = static_cast<uint32_t>(scratch.lists.size());
  const uint32_t size = options.bucket_size;
  scratch.buckets.reset(regions, kUninitialized);
  const View<LightBuckets> buckets = scratch.buckets.mutable_view();
  const CountBucketsKernel count{
      scratch.lists.view(), scratch.lights.view(), buckets_.view(), size, options.hysteresis, buckets};
  launch(backend, "vlc.buckets", count, regions, 1);
  scratch.offsets.reset(regions, kUninitialized);
  const uint64_t bucket_count = exclusive_scan({backend, "vlc.buckets", scratch.primitives},
                                               BucketCounts{scratch.buckets.view()}, scratch.offsets.mutable_view());
  launch(backend, "vlc.buckets", SetBucketOffsetsKernel{scratch.offsets.view(), size, buckets}, regions, 1, {},
         kRegionsPerTile);
  scratch.entries.reset(bucket_count * size, kUninitialized);
  scratch.bucket_weights.reset(bucket_count, kUninitialized);
  const FillBucketsKernel fill_in{scratch.lists.view(),           scratch.lights.view(),
                                  scratch.buckets.view(),         size,
                                  scratch.entries.mutable_view(), scratch.dropped.mutable_view()};
  launch(backend, "vlc.buckets", fill_in, regions, 1);
  const BucketWeightsKernel weigh{tree.view(),
                                  tree.links().parents.view(),
                                  scratch.buckets.view(),
                                  scratch.entries.view(),
                                  lights,
                                  size,
                                  options.even_buckets,
                                  scratch.bucket_weights.mutable_view(),
                                  options.first_infinite,
                                  sqr(options.scene_radius),
                                  scratch.shares.view()};
  launch(backend, "vlc.buckets", weigh, regions, 1);
}

void LightCaches::populate(Backend& backend, const OctreeTree& next, CacheScratch& scratch) {
  const uint32_t regions = next.leaf_slots();
  scratch.buckets.reset(regions, kUninitialized);
  scratch.lists.reset(regions, kUninitialized);
  const InheritCachesKernel kernel{next.links().previous.view(), buckets_.view(), lists_.view(),
                                   scratch.buckets.mutable_view(), scratch.lists.mutable_view()};
  launch(backend, "vlc.populate", kernel, regions, 1, {}, kRegionsPerTile);
  if (!shares_.empty()) {
    scratch.shares.reset(regions, kUninitialized);
    const InheritSharesKernel inherit{next.links().previous.view(), shares_.view(), scratch.shares.mutable_view()};
    launch(backend, "vlc.populate", inherit, regions, 1, {}, kRegionsPerTile);
    shares_.swap(scratch.shares);
  }
  buckets_.swap(scratch.buckets);
  lists_.swap(scratch.lists);
}

LightCaches LightCaches::copy(Backend& backend) const {
  LightCaches result(buckets_.memory());
  const auto copy_to = [&](const auto& from, auto& to) { relume::copy(backend, "vlc.copy", from, to); };
  copy_to(buckets_, result.buckets_);
  copy_to(lists_, result.lists_);
  copy_to(entries_, result.entries_);
  copy_to(bucket_weights_, result.bucket_weights_);
  copy_to(lights_, result.lights_);
  copy_to(shares_, result.shares_);
  result.dropped_ = dropped_;
  return result;
}

size_t LightCaches::region_bytes() const {
  return buckets_.size() * sizeof(LightBuckets) + lists_.size() * sizeof(LightList) +
         shares_.size() * sizeof(LightShares);
}

size_t LightCaches::entry_bytes() const {
  return entries_.size() * sizeof(uint32_t) + lights_.size() * sizeof(uint32_t) +
         bucket_weights_.size() * sizeof(float);
}

bool LightCaches::consistent(uint32_t bucket_size, uint32_t light_count) const {
  const std::span<const LightBuckets> buckets = buckets_.read();
  const std::span<const uint32_t> entries = entries_.read();
  const std::span<const float> weights = bucket_weights_.read();
  if (entries.size() != size_t{bucket_size} * weights.size()) return false;
  for (const uint32_t entry : entries)
    if (entry != CachedLight::kNone && CachedLight::id(entry) >= light_count) return false;
  return std::all_of(buckets.begin(), buckets.end(), [&](const LightBuckets& b) {
    float sum = 0;
    for (uint32_t i = 0; i < b.count; ++i) {
      const float weight = weights[b.first / bucket_size + i];
      const bool empty = entries[b.first + i * bucket_size] == CachedLight::kNone;
      if (!(weight >= 0.0f) || (empty && weight > 0.0f)) return false;
      sum += weight;
    }
    return b.count == 0 || (std::fabs(sum - 1.0f) < 1e-3f && std::has_single_bit(b.count));
  });
}

void LightCaches::clear() { *this = LightCaches(buckets_.memory()); }

void LightCaches::save(std::ostream& out) const {
  write_array(out, buckets_);
  write_array(out, lists_);
  write_array(out, lights_);
  write_array(out, entries_);
  write_array(out, bucket_weights_);
  write_array(out, shares_);
}

void LightCaches::load(std::istream& in) {
  read_array(in, buckets_);
  read_array(in, lists_);
  read_array(in, lights_);
  read_array(in, entries_);
  read_array(in, bucket_weights_);
  read_array(in, shares_);
  const std::span<const LightBuckets> buckets = buckets_.read();
  const std::span<const LightList> lists = lists_.read();
  uint64_t listed = 0;
  const auto inside = [&](const LightList& list) {
    listed += list.count;
    return list.first <= lights_.size() && list.count <= lights_.size() - list.first;
  };
  const size_t bucket_size = bucket_weights_.empty() ? 0 : entries_.size() / bucket_weights_.size();
  const auto has_entries = [&](const LightBuckets& b) {
    return b.count == 0 || (bucket_size > 0 && b.first % bucket_size == 0 &&
                            b.first + uint64_t{b.count} * bucket_size <= entries_.size());
  };
  const bool whole_buckets = entries_.size() == bucket_size * bucket_weights_.size() &&
                             std::all_of(buckets.begin(), buckets.end(), has_entries);
  // The eight children of a split region share its list. More overlap would leave sums of lengths unbounded.
  const std::span<const LightShares> shares = shares_.read();
  const bool valid_shares = (shares.empty() || shares.size() == buckets.size()) &&
                            std::all_of(shares.begin(), shares.end(), [](const LightShares& s) { return s.valid(); });
  if (in && whole_buckets && valid_shares && lists.size() == buckets.size() &&
      std::all_of(lists.begin(), lists.end(), inside) &&
      listed <= std::min<uint64_t>(8 * uint64_t{lights_.size()}, kMostListed)) {
    return;
  }
  clear();
  in.setstate(std::ios::failbit);
}

}  // namespace relume
