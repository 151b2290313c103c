// Discards the oldest cells of a hash grid, and counts the keys of waiting samples.
#pragma once

#include <algorithm>
#include <bit>

#include "core/array.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/primitive.h"
#include "techniques/spatial/hash_grid/hash_grid.h"
#include "techniques/spatial/hash_grid/settings.h"

namespace relume {

/// Sort key of a cell, kBytes bytes long. Cells with larger keys are discarded first: older cells, and among cells of
/// equal age those with fewer samples. Fingerprint and bucket hash make the order total, so the choice does not depend
/// on slots.
struct DiscardKey {
  static constexpr uint32_t kBytes = 20;

  uint32_t words[kBytes / 4] = {};  ///< the most significant first

  RELUME_HD static DiscardKey of(const CellHistory& history, const CellAddress& address) {
    const uint32_t count = float_bits(history.moments.count);  // positive floats sort like their bits
    return {{history.age, ~count, static_cast<uint32_t>(address.fingerprint >> 32),
             static_cast<uint32_t>(address.fingerprint), address.bucket_hash}};
  }

  RELUME_HD uint32_t byte(uint32_t i) const { return (words[i / 4] >> shift(i)) & 0xffu; }
  RELUME_HD void set_byte(uint32_t i, uint32_t value) { words[i / 4] |= value << shift(i); }
  /// Whether the first `bytes` bytes are those of `other`.
  RELUME_HD bool has_prefix(const DiscardKey& other, uint32_t bytes) const {
    for (uint32_t i = 0; i < bytes / 4; ++i)
      if (words[i] != other.words[i]) return false;
    return bytes % 4 == 0 || ((words[bytes / 4] ^ other.words[bytes / 4]) >> (32 - 8 * (bytes % 4))) == 0;
  }
  RELUME_HD bool operator<(const DiscardKey& other) const {
    for (uint32_t i = 0; i < kBytes / 4; ++i)
      if (words[i] != other.words[i]) return words[i] < other.words[i];
    return false;
  }

 private:
  RELUME_HD static uint32_t shift(uint32_t i) { return 24 - 8 * (i % 4); }
};

/// The cells of a grid with their keys.
struct KeyedCells {
  View<const uint64_t> fingerprints;
  View<const uint32_t> bucket_hashes;
  View<const CellHistory> histories;

  RELUME_HD bool is_live(uint32_t slot) const { return !histories[slot].empty(); }
  RELUME_HD DiscardKey key(uint32_t slot) const {
    return DiscardKey::of(histories[slot], {fingerprints[slot], bucket_hashes[slot]});
  }
};

/// Number of values of a byte.
inline constexpr uint32_t kByteValues = 256;

/// Counts the values of byte `place` of the keys that begin with that many bytes of `prefix`; one call per
/// kPrimitiveBlock slots.
struct CountKeyBytesKernel {
  KeyedCells cells;
  DiscardKey prefix;
  uint32_t place = 0;
  View<uint32_t> counts;  ///< kByteValues

  RELUME_HD void operator()(uint32_t index, uint32_t) const {
    uint32_t counts_here[kByteValues] = {};
    const PrimitiveBlock block(index, cells.histories.size);
    for (size_t i = block.begin; i < block.end; ++i) {
      const auto slot = static_cast<uint32_t>(i);
      if (!cells.is_live(slot)) continue;
      const DiscardKey key = cells.key(slot);
      if (key.has_prefix(prefix, place)) ++counts_here[key.byte(place)];
    }
    for (uint32_t value = 0; value < kByteValues; ++value)
      if (counts_here[value] > 0) atomic_add(&counts[value], counts_here[value]);
  }
};

/// Empties cells whose key is not below `threshold`; one call per slot.
struct DiscardCellsKernel {
  KeyedCells cells;
  DiscardKey threshold;
  View<CellHistory> histories;

  RELUME_HD void operator()(uint32_t slot, uint32_t) const {
    if (cells.is_live(slot) && !(cells.key(slot) < threshold)) histories[slot] = {};
  }
};

/// Lower bound on the `count` largest keys, above all other keys; 0 < count ≤ number of live cells. Determines one byte
/// at a time, and stops as soon as all cells with that prefix are among the `count`; later bytes are then 0.
inline DiscardKey discard_threshold(Backend& backend, std::string_view name, const KeyedCells& cells, uint64_t count,
                                    Memory& memory) {
  Array<uint32_t> counts(memory);
  DiscardKey threshold;
  uint64_t left = count;
  for (uint32_t place = 0; place < DiscardKey::kBytes; ++place) {
    reset(backend, name, counts, kByteValues, 0u);
    const CountKeyBytesKernel kernel{cells, threshold, place, counts.mutable_view()};
    launch(backend, name, kernel, primitive_blocks(cells.histories.size), 1);
    const std::span<const uint32_t> found = counts.read();
    uint32_t value = kByteValues - 1;
    for (; value > 0 && found[value] < left; --value) left -= found[value];
    threshold.set_byte(place, value);
    if (found[value] == left) break;
  }
  return threshold;
}

/// Inserts the keys of waiting samples into a set, until it is half full; one call per sample.
struct CountDistinctKeysKernel {
  View<const WaitingSample> samples;
  CellKeys keys;
  View<uint64_t> set;       ///< initially 0; its size is a power of two
  View<uint64_t> distinct;  ///< one element: number of keys in the set

  RELUME_HD void operator()(uint32_t i, uint32_t) const {
    if (atomic_load(distinct.data) >= set.size / 2) return;
    const uint64_t key = keys.address(samples[i].point, samples[i].coarser).fingerprint;
    const uint32_t mask = set.size - 1;
    for (uint32_t slot = static_cast<uint32_t>(key) & mask;; slot = (slot + 1) & mask) {
      const uint64_t found = atomic_compare_exchange(&set[slot], 0, key);
      if (found == key) return;
      if (found == 0) return atomic_add(distinct.data, uint64_t{1});
    }
  }
};

/// Number of distinct keys of waiting samples. Exact up to 2 kMostSlots; above, at least 2 kMostSlots. `set`: memory
/// for the keys, two to four per sample.
inline uint64_t distinct_keys(Backend& backend, std::string_view name, View<const WaitingSample> samples,
                              const CellKeys& keys, Array<uint64_t>& set) {
  KernelValue<uint64_t> distinct(set.memory());
  // Half of the set has room for a key of each sample.
  reset(backend, name, set, std::min(std::bit_ceil(2 * uint64_t{samples.size}), 4 * uint64_t{kMostSlots}));
  const CountDistinctKeysKernel kernel{samples, keys, set.mutable_view(), distinct.mutable_view()};
  launch(backend, name, kernel, samples.size, 1, {}, kFillTile);
  return distinct.read();
}

}  // namespace relume
