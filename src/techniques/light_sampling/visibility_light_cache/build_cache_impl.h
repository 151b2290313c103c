// Kernels of build_cache.h.
#pragma once

#include "core/fixed_point.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"

namespace relume {

RELUME_HD inline uint32_t DeduplicateLightsKernel::visible_light(uint32_t region, uint32_t i, uint32_t read) const {
  const auto spread = static_cast<uint32_t>(uint64_t{i} * samples.counts[region] / read);
  const uint32_t light = samples.sample(region, spread).light;
  const bool visible = light != kNoLight && (light & kVisibleLight);
  return visible && (light & ~kVisibleLight) < light_count ? light & ~kVisibleLight : light_cache::LightSet::kFree;
}

template <typename Group>
RELUME_HD void DeduplicateLightsKernel::operator()(const Group& group, Shared& shared, uint32_t region,
                                                   uint32_t) const {
  constexpr uint32_t kFree = light_cache::LightSet::kFree;
  const uint32_t read = relume::min(samples.counts[region], max_samples);
  if (read == 0) return group.each(1, [&](uint32_t) { counts[region] = 0; });
  light_cache::LightSet& set = shared.set;
  set.clear(group, read);
  group.each(1, [&](uint32_t) { shared.written = shared.lost = 0; });
  for (uint32_t first = 0; first < read; first += kThreads) {
    const uint32_t size = relume::min(read - first, kThreads);
    group.each(size, [&](uint32_t i) { shared.batch[i] = visible_light(region, first + i, read); });
    if (set.count + size <= kMaxSeenLights) {
      group.each(size, [&](uint32_t i) {
        if (shared.batch[i] != kFree) set.insert_concurrently(shared.batch[i]);
      });
    } else {  // which lights are dropped depends on the order
      group.each(1, [&](uint32_t) {
        for (uint32_t i = 0; i < size; ++i) {
          if (shared.batch[i] != kFree) shared.lost += set.insert(shared.batch[i]);
        }
      });
    }
  }
  group.each(set.mask + 1, [&](uint32_t i) {
    if (set.slots[i] != kFree) shared.lights[atomic_fetch_add(&shared.written, 1u)] = set.slots[i];
  });
  const uint32_t written = shared.written;
  light_cache::sort(group, shared.lights, written);
  group.each(written, [&](uint32_t i) { seen[samples.offsets[region] + i] = shared.lights[i]; });
  group.each(1, [&](uint32_t) { finish(region, written, shared.lost); });
}

inline void DeduplicateLightsKernel::on_host(uint32_t region, uint32_t) const {
  const uint32_t read = relume::min(samples.counts[region], max_samples);
  counts[region] = 0;
  if (read == 0) return;
  light_cache::LightSet set;
  set.clear(read);
  uint32_t lost = 0;
  for (uint32_t i = 0; i < read; ++i) {
    const uint32_t light = visible_light(region, i, read);
    if (light != light_cache::LightSet::kFree) lost += set.insert(light);
  }
  uint32_t* out = &seen[samples.offsets[region]];
  uint32_t written = 0;
  for (uint32_t i = 0; i <= set.mask; ++i) {
    if (set.slots[i] != light_cache::LightSet::kFree) out[written++] = set.slots[i];
  }
  light_cache::sort(out, written);
  finish(region, written, lost);
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
