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
  std::vector<uint64_t> dropped{0};
  std::vector<uint32_t> seen(samples.order.size);
  std::vector<uint32_t> seen_counts(regions);
  launch(backend, "vlc.deduplicate",
         DeduplicateLightsKernel{samples, lights.size, options.max_samples, mutable_view_of(seen),
                                 mutable_view_of(seen_counts), mutable_view_of(dropped)},
         regions, 1);

  std::vector<uint32_t> places(regions);
  std::vector<LightList> lists(regions);
  MergeLightsKernel merge;
  merge.samples = samples;
  merge.seen = view_of(seen);
  merge.seen_counts = view_of(seen_counts);
  merge.neighbours = view_of(tree.links().neighbours);
  merge.old_lists = view_of(lists_);
  merge.old_lights = view_of(lights_);
  merge.light_count = lights.size;
  merge.memory = options.memory;
  std::vector<uint32_t> listed;
  backend.run("vlc.merge", [&] {
    uint32_t total = 0;
    for (uint32_t i = 0; i < regions; ++i) {
      places[i] = total;
      total += merge.bound(i);
    }
    listed.resize(total);
  });
  merge.places = view_of(places);
  merge.lights = mutable_view_of(listed);
  merge.lists = mutable_view_of(lists);
  launch(backend, "vlc.merge", merge, regions, 1);

  lists_ = std::move(lists);
  lights_ = std::move(listed);
  fill_buckets(backend, tree, lights, options, dropped);
  dropped_ = dropped[0];
}

void LightCaches::fill_buckets(Backend& backend, const OctreeTree& tree, View<const LightSummary> lights,
                               const CacheBuildOptions& options, std::vector<uint64_t>& dropped) {
  const auto regions = static_cast<uint32_t>(lists_.size());
  std::vector<LightBuckets> buckets(regions);
  launch(backend, "vlc.buckets",
         CountBucketsKernel{view_of(lists_), view_of(lights_), view_of(buckets_), options.bucket_size,
                            options.hysteresis, mutable_view_of(buckets)},
         regions, 1);
  backend.run("vlc.buckets", [&] {
    uint32_t entries = 0;
    for (LightBuckets& b : buckets) {
      b.first = entries;
      entries += b.count * options.bucket_size;
    }
    entries_.resize(entries);
    bucket_weights_.resize(entries / options.bucket_size);
  });
  launch(backend, "vlc.buckets",
         FillBucketsKernel{view_of(lists_), view_of(lights_), view_of(buckets), options.bucket_size,
                           mutable_view_of(entries_), mutable_view_of(dropped)},
         regions, 1);
  launch(backend, "vlc.buckets",
         BucketWeightsKernel{tree.view(), view_of(tree.links().parents), view_of(buckets), view_of(entries_), lights,
                             options.bucket_size, options.even_buckets, mutable_view_of(bucket_weights_)},
         regions, 1);
  buckets_ = std::move(buckets);
}

void LightCaches::populate(Backend& backend, const OctreeTree& next) {
  backend.run("vlc.populate", [&] {
    const uint32_t regions = next.leaf_slots();
    std::vector<LightBuckets> buckets(regions);
    std::vector<LightList> lists(regions);
    for (uint32_t i = 0; i < regions; ++i) {
      const uint32_t from = next.links().previous[i];
      if (from >= buckets_.size()) continue;
      buckets[i] = buckets_[from];
      lists[i] = lists_[from];
    }
    buckets_ = std::move(buckets);
    lists_ = std::move(lists);
  });
}

size_t LightCaches::region_bytes() const {
  return buckets_.capacity() * sizeof(LightBuckets) + lists_.capacity() * sizeof(LightList);
}

size_t LightCaches::entry_bytes() const {
  return (entries_.capacity() + lights_.capacity()) * sizeof(uint32_t) + bucket_weights_.capacity() * sizeof(float);
}

bool LightCaches::consistent(uint32_t bucket_size, uint32_t light_count) const {
  if (entries_.size() != size_t{bucket_size} * bucket_weights_.size()) return false;
  for (const uint32_t entry : entries_)
    if (entry != CachedLight::kNone && CachedLight::id(entry) >= light_count) return false;
  return std::all_of(buckets_.begin(), buckets_.end(), [&](const LightBuckets& b) {
    float sum = 0;
    for (uint32_t i = 0; i < b.count; ++i) {
      const float weight = bucket_weights_[b.first / bucket_size + i];
      const bool empty = entries_[b.first + i * bucket_size] == CachedLight::kNone;
      if (!(weight >= 0.0f) || (empty && weight > 0.0f)) return false;
      sum += weight;
    }
    return b.count == 0 || (std::fabs(sum - 1.0f) < 1e-3f && std::has_single_bit(b.count));
  });
}

void LightCaches::save(std::ostream& out) const {
  write_vector(out, buckets_);
  write_vector(out, lists_);
  write_vector(out, lights_);
  write_vector(out, entries_);
  write_vector(out, bucket_weights_);
}

void LightCaches::load(std::istream& in) {
  read_vector(in, buckets_);
  read_vector(in, lists_);
  read_vector(in, lights_);
  read_vector(in, entries_);
  read_vector(in, bucket_weights_);
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
                             std::all_of(buckets_.begin(), buckets_.end(), has_entries);
  // The eight children of a split region share its list. More overlap would leave sums of lengths unbounded.
  if (in && whole_buckets && lists_.size() == buckets_.size() && std::all_of(lists_.begin(), lists_.end(), inside) &&
      listed <= std::min<uint64_t>(8 * uint64_t{lights_.size()}, kMostListed)) {
    return;
  }
  *this = {};
  in.setstate(std::ios::failbit);
}

}  // namespace relume
