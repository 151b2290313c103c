// Kernels of build_cache.h.
#pragma once

#include "core/fixed_point.h"
#include "core/hash.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"

namespace relume {

namespace light_cache {

/// A hash set of lights with open addressing.
struct LightSet {
  static constexpr uint32_t kMostSlots = 2 * kMaxSeenLights;
  static constexpr uint32_t kFree = 0xffffffffu;

  uint32_t slots[kMostSlots];
  uint32_t mask;  ///< slots in use − 1; a power of two slots, at least twice the lights
  uint32_t count;

  RELUME_HD void clear(uint32_t expected) {
    mask = 15;
    while (mask + 1 < 2 * expected && mask + 1 < kMostSlots) mask = 2 * mask + 1;
    for (uint32_t i = 0; i <= mask; ++i) slots[i] = kFree;
    count = 0;
  }
  /// Returns 1 if the set is full, otherwise 0.
  RELUME_HD uint32_t insert(LightId light) {
    for (uint32_t i = hash(light) & mask;; i = (i + 1) & mask) {
      if (slots[i] == light) return 0;
      if (slots[i] != kFree) continue;
      if (count == kMaxSeenLights) return 1;
      slots[i] = light;
      ++count;
      return 0;
    }
  }
};

/// Heap sort: in place and without recursion.
RELUME_HD inline void sort(uint32_t* values, uint32_t count) {
  const auto sink = [values](uint32_t i, uint32_t end) {
    const uint32_t value = values[i];
    for (uint32_t child = 2 * i + 1; child < end; child = 2 * i + 1) {
      if (child + 1 < end && values[child + 1] > values[child]) ++child;
      if (values[child] <= value) break;
      values[i] = values[child];
      i = child;
    }
    values[i] = value;
  };
  for (uint32_t i = count / 2; i-- > 0;) sink(i, count);
  for (uint32_t end = count; end > 1;) {
    --end;
    const uint32_t largest = values[0];
    values[0] = values[end];
    values[end] = largest;
    sink(0, end);
  }
}

}  // namespace light_cache

RELUME_HD inline void DeduplicateLightsKernel::operator()(uint32_t region, uint32_t) const {
  const uint32_t count = samples.counts[region];
  counts[region] = 0;
  if (count == 0) return;
  light_cache::LightSet set;
  const uint32_t looked_at = count < max_samples ? count : max_samples;
  set.clear(looked_at);
  uint32_t lost = 0;
  for (uint32_t i = 0; i < looked_at; ++i) {
    const auto spread = static_cast<uint32_t>(uint64_t{i} * count / looked_at);
    const uint32_t light = samples.sample(region, spread).light;
    const bool visible = light != kNoLight && (light & kVisibleLight);
    if (visible && (light & ~kVisibleLight) < light_count) lost += set.insert(light & ~kVisibleLight);
  }
  if (lost > 0) atomic_add(&dropped[0], uint64_t{lost});
  uint32_t* out = &seen[samples.offsets[region]];
  uint32_t written = 0;
  for (uint32_t i = 0; i <= set.mask; ++i) {
    if (set.slots[i] != light_cache::LightSet::kFree) out[written++] = set.slots[i];
  }
  light_cache::sort(out, written);
  counts[region] = written;
}

RELUME_HD inline uint32_t MergeLightsKernel::bound(uint32_t region) const {
  uint32_t sum = seen_counts[region];
  for (uint32_t face = 0; face < 6; ++face) {
    const uint32_t neighbour = neighbours[6 * region + face];
    if (neighbour != kNoRegion) sum += seen_counts[neighbour];
  }
  return sum + (memory > 0 && region < old_lists.size ? old_lists[region].count : 0u);
}

RELUME_HD inline void MergeLightsKernel::operator()(uint32_t region, uint32_t) const {
  // Merges up to seven sorted lists of ids and the old list.
  const uint32_t* head[7];
  const uint32_t* end[7];
  uint32_t lists_here = 0;
  const auto add = [&](uint32_t from) {
    if (seen_counts[from] == 0) return;
    head[lists_here] = &seen[samples.offsets[from]];
    end[lists_here] = head[lists_here] + seen_counts[from];
    ++lists_here;
  };
  add(region);
  for (uint32_t face = 0; face < 6; ++face) {
    if (neighbours[6 * region + face] != kNoRegion) add(neighbours[6 * region + face]);
  }
  const uint32_t* old = nullptr;
  const uint32_t* old_end = nullptr;
  if (memory > 0 && region < old_lists.size) {
    old = old_lights.data + old_lists[region].first;
    old_end = old + old_lists[region].count;
  }
  uint32_t written = 0;
  for (;;) {
    LightId least = kNoLight;
    for (uint32_t k = 0; k < lists_here; ++k) {
      if (head[k] != end[k] && *head[k] < least) least = *head[k];
    }
    uint32_t age = 0;
    if (old != old_end && CachedLight::id(*old) <= least) {
      const LightId known = CachedLight::id(*old);
      if (known < least) age = CachedLight::age(*old) + 1;  // not seen in this frame
      least = known;
      ++old;
    }
    if (least == kNoLight) break;
    for (uint32_t k = 0; k < lists_here; ++k) {
      if (head[k] != end[k] && *head[k] == least) ++head[k];
    }
    if (age <= memory && least < light_count) lights[offsets[region] + written++] = CachedLight::pack(least, age);
  }
  lists[region] = {offsets[region], written};
}

RELUME_HD inline void CountBucketsKernel::operator()(uint32_t region, uint32_t) const {
  const LightList list = lists[region];
  buckets[region] = {};
  if (list.count == 0) return;
  uint32_t fill[kMaxBuckets] = {};
  for (uint32_t i = 0; i < list.count; ++i) ++fill[CachedLight::id(lights[list.first + i]) % kMaxBuckets];
  const uint32_t before = region < old_buckets.size ? old_buckets[region].count : 0u;
  const auto tight = relume::max(1u, static_cast<uint32_t>(hysteresis * static_cast<float>(bucket_size)));
  uint32_t count = kMaxBuckets;
  while (count > 1) {
    const uint32_t half = count / 2;
    // Only spare room reduces the last frame's number, so that it does not flicker.
    const uint32_t room = half < before ? tight : bucket_size;
    bool fits = true;
    for (uint32_t b = 0; b < half; ++b) fits = fits && fill[b] + fill[b + half] <= room;
    if (!fits) break;
    for (uint32_t b = 0; b < half; ++b) fill[b] += fill[b + half];
    count = half;
  }
  buckets[region].count = count;
}

RELUME_HD inline void FillBucketsKernel::operator()(uint32_t region, uint32_t) const {
  const LightBuckets b = buckets[region];
  const LightList list = lists[region];
  uint32_t fill[kMaxBuckets] = {};
  uint32_t lost = 0;
  for (uint32_t i = 0; i < list.count; ++i) {
    const uint32_t light = lights[list.first + i];
    const uint32_t bucket = CachedLight::id(light) % b.count;
    if (fill[bucket] == bucket_size) {
      ++lost;
    } else {
      entries[b.first + bucket * bucket_size + fill[bucket]++] = light;
    }
  }
  for (uint32_t bucket = 0; bucket < b.count; ++bucket) {
    for (uint32_t i = fill[bucket]; i < bucket_size; ++i)
      entries[b.first + bucket * bucket_size + i] = CachedLight::kNone;
  }
  if (lost > 0) atomic_add(&dropped[0], uint64_t{lost});
}

}  // namespace relume
