// Distinct lights of a region, and their order by id.
#pragma once

#include "core/fixed_point.h"
#include "core/hash.h"
#include "lights/light.h"

namespace relume {

/// Maximum number of distinct lights from one region's samples per frame; the excess is dropped and counted.
inline constexpr uint32_t kMaxSeenLights = 1024;

namespace light_cache {

/// A hash set of lights with open addressing.
struct LightSet {
  static constexpr uint32_t kMostSlots = 2 * kMaxSeenLights;
  static constexpr uint32_t kFree = 0xffffffffu;  ///< not the id of a light

  uint32_t slots[kMostSlots];
  uint32_t mask;  ///< slots in use − 1; a power of two slots, at least twice the lights
  uint32_t count;

  RELUME_HD void clear(uint32_t expected) {
    mask = mask_for(expected);
    for (uint32_t i = 0; i <= mask; ++i) slots[i] = kFree;
    count = 0;
  }
  /// The same by a group of threads.
  template <typename Group>
  RELUME_HD void clear(const Group& group, uint32_t expected) {
    const uint32_t last = mask_for(expected);
    group.each(last + 1, [&](uint32_t i) { slots[i] = kFree; });
    group.each(1, [&](uint32_t) {
      mask = last;
      count = 0;
    });
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
  /// Thread-safe insertion. The set must have room for the lights of all threads.
  RELUME_HD void insert_concurrently(LightId light) {
    for (uint32_t i = hash(light) & mask;; i = (i + 1) & mask) {
      const uint32_t found = atomic_compare_exchange(&slots[i], kFree, light);
      if (found == kFree) return atomic_add(&count, 1u);
      if (found == light) return;
    }
  }

 private:
  RELUME_HD static uint32_t mask_for(uint32_t expected) {
    uint32_t mask = 15;
    while (mask + 1 < 2 * expected && mask + 1 < kMostSlots) mask = 2 * mask + 1;
    return mask;
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

/// The same by a group of threads (bitonic sort). `values` has room for the next power of two after `count`; the room
/// beyond `count` is overwritten.
template <typename Group>
RELUME_HD void sort(const Group& group, uint32_t* values, uint32_t count) {
  uint32_t padded = 1;
  while (padded < count) padded *= 2;
  group.each(padded - count, [&](uint32_t i) { values[count + i] = 0xffffffffu; });
  for (uint32_t run = 2; run <= padded; run *= 2) {
    for (uint32_t step = run / 2; step > 0; step /= 2) {
      group.each(padded / 2, [&](uint32_t i) {
        const uint32_t low = 2 * i - (i & (step - 1));
        const uint32_t first = values[low];
        const uint32_t second = values[low + step];
        const bool ascending = (low & run) == 0;
        if ((first > second) != ascending) return;
        values[low] = second;
        values[low + step] = first;
      });
    }
  }
}

}  // namespace light_cache
}  // namespace relume
