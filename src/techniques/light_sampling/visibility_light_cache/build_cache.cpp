#include "techniques/light_sampling/visibility_light_cache/build_cache.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/stream_io.h"

namespace relume {
namespace {

/// Maximum total length of lists: positions have 32 bits.
constexpr uint64_t kMostListed = uint64_t{1} << 31;

}  // namespace

void LightCaches::build(Backend& backend, const OctreeTree& tree, const SampleGroupsView& samples,
                        View<const LightSummary> lights, const CacheBuildOptions& options) {
  const uint32_t regions = tree.leaf_slots();
  Memory& memory = lists_.memory();
  KernelValue<uint64_t> dropped(memory);
  Array<uint32_t> seen(memory);
  Array<uint32_t> seen_counts(memory);
  seen.reset(samples.order.size);
  seen_counts.reset(regions);
  launch(backend, "vlc.deduplicate",
         DeduplicateLightsKernel{samples, lights.size, options.max_samples, seen.mutable_view(),
                                 seen_counts.mutable_view(), dropped.mutable_view()},
         regions, 1);

  Array<uint32_t> places(memory);
  Array<LightList> lists(memory);
  Array<uint32_t> listed(memory);
  places.reset(regions);
  lists.reset(regions);
  MergeLightsKernel merge;
  merge.samples = samples;
  merge.seen = seen.view();
  merge.seen_counts = seen_counts.view();
  merge.neighbours = tree.links().neighbours.view();
  merge.old_lists = lists_.view();
  merge.old_lights = lights_.view();
  merge.light_count = lights.size;
  merge.memory = options.memory;
  backend.run("vlc.merge", [&] {
    const std::span<uint32_t> place = places.write();
    uint32_t total = 0;
    for (uint32_t i = 0; i < regions; ++i) {
      place[i] = total;
      total += merge.bound(i);
    }
    listed.reset(total);
  });
  merge.places = places.view();
  merge.lights = listed.mutable_view();
  merge.lists = lists.mutable_view();
  launch(backend, "vlc.merge", merge, regions, 1);

  lists_ = std::move(lists);
  lights_ = std::move(listed);
  fill_buckets(backend, tree, lights, options, dropped.mutable_view());
  dropped_ = dropped.read();
}

void LightCaches::fill_buckets(Backend& backend, const OctreeTree& tree, View<const LightSummary> lights,
                               const CacheBuildOptions& options, View<uint64_t> dropped) {
  const auto regions = static_cast<uint32_t>(lists_.size());
  Array<LightBuckets> buckets(buckets_.memory());
  buckets.reset(regions);
  launch(backend, "vlc.buckets",
         CountBucketsKernel{lists_.view(), lights_.view(), buckets_.view(), options.bucket_size, options.hysteresis,
                            buckets.mutable_view()},
         regions, 1);
  backend.run("vlc.buckets", [&] {
    uint32_t entries = 0;
    for (LightBuckets& b : buckets.write()) {
      b.first = entries;
      entries += b.count * options.bucket_size;
    }
    entries_.reset(entries, kUninitialized);
    bucket_weights_.reset(entries / options.bucket_size, kUninitialized);
  });
  launch(backend, "vlc.buckets",
         FillBucketsKernel{lists_.view(), lights_.view(), buckets.view(), options.bucket_size, entries_.mutable_view(),
                           dropped},
         regions, 1);
  launch(backend, "vlc.buckets",
         BucketWeightsKernel{tree.view(), tree.links().parents.view(), buckets.view(), entries_.view(), lights,
                             options.bucket_size, options.even_buckets, bucket_weights_.mutable_view()},
         regions, 1);
  buckets_ = std::move(buckets);
}

void LightCaches::populate(Backend& backend, const OctreeTree& next) {
  backend.run("vlc.populate", [&] {
    const uint32_t regions = next.leaf_slots();
    Array<LightBuckets> next_buckets(buckets_.memory());
    Array<LightList> next_lists(lists_.memory());
    next_buckets.reset(regions);
    next_lists.reset(regions);
    const std::span<LightBuckets> buckets = next_buckets.write();
    const std::span<LightList> lists = next_lists.write();
    const std::span<const LightBuckets> old_buckets = buckets_.read();
    const std::span<const LightList> old_lists = lists_.read();
    const std::span<const uint32_t> previous = next.links().previous.read();
    for (uint32_t i = 0; i < regions; ++i) {
      const uint32_t from = previous[i];
      if (from >= old_buckets.size()) continue;
      buckets[i] = old_buckets[from];
      lists[i] = old_lists[from];
    }
    buckets_ = std::move(next_buckets);
    lists_ = std::move(next_lists);
  });
}

size_t LightCaches::region_bytes() const { return buckets_.memory_bytes() + lists_.memory_bytes(); }

size_t LightCaches::entry_bytes() const {
  return entries_.memory_bytes() + lights_.memory_bytes() + bucket_weights_.memory_bytes();
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
}

void LightCaches::load(std::istream& in) {
  read_array(in, buckets_);
  read_array(in, lists_);
  read_array(in, lights_);
  read_array(in, entries_);
  read_array(in, bucket_weights_);
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
  if (in && whole_buckets && lists.size() == buckets.size() && std::all_of(lists.begin(), lists.end(), inside) &&
      listed <= std::min<uint64_t>(8 * uint64_t{lights_.size()}, kMostListed)) {
    return;
  }
  clear();
  in.setstate(std::ios::failbit);
}

}  // namespace relume
