// Groups indices by key, in the order of a stable sort.
#pragma once

#include <algorithm>
#include <optional>
#include <stop_token>

#include "frame/primitives/scan.h"

namespace relume {

/// Indices in the order of their keys.
struct KeyGroups {
  explicit KeyGroups(Memory& memory = host_memory()) : order(memory), begins(memory) {}

  Array<uint32_t> order;   ///< indices, group by group; ascending within a group
  Array<uint32_t> begins;  ///< first index into `order` of each key, then the total

  size_t memory_bytes() const { return order.memory_bytes() + begins.memory_bytes(); }
};

/// Counts the keys of each part of the indices; one call per part.
template <typename Keys>
struct CountKeysKernel {
  Keys keys;
  uint32_t elements = 0;
  uint32_t key_count = 0;
  uint32_t part_size = 0;
  View<uint32_t> counts;  ///< by part and key

  RELUME_HD void operator()(uint32_t part, uint32_t) const {
    uint32_t* const counts_here = counts.data + size_t{part} * key_count;
    for (uint32_t key = 0; key < key_count; ++key) counts_here[key] = 0;
    const size_t begin = size_t{part} * part_size;
    const size_t end = begin + part_size < elements ? begin + part_size : elements;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t key = keys(i);
      if (key < key_count) ++counts_here[key];
    }
  }
};

/// Replaces the counts of each key by their prefix sums over parts, and writes the total; one call per key, and one
/// for the element after the last key, whose total is zero.
struct KeyTotalsKernel {
  uint32_t key_count = 0;
  uint32_t parts = 0;
  View<uint32_t> counts;
  View<uint32_t> totals;  ///< by key

  RELUME_HD void operator()(uint32_t key, uint32_t) const {
    uint32_t sum = 0;
    for (uint32_t part = 0; key < key_count && part < parts; ++part)
      add(counts.data[size_t{part} * key_count + key], sum);
    totals[key] = sum;
  }
  void operator()(const Tile& tile) const {
    std::fill(totals.data + tile.x0, totals.data + tile.x1, 0u);
    const uint32_t end = std::min(tile.x1, key_count);
    for (uint32_t part = 0; part < parts; ++part) {
      uint32_t* const counts_here = counts.data + size_t{part} * key_count;
      for (uint32_t key = tile.x0; key < end; ++key) add(counts_here[key], totals[key]);
    }
  }

 private:
  RELUME_HD static void add(uint32_t& count, uint32_t& sum) {
    const uint32_t here = count;
    count = sum;
    sum += here;
  }
};

/// Writes the indices of each part, from its offset for each key on; one call per part.
template <typename Keys>
struct OrderByKeyKernel {
  Keys keys;
  uint32_t elements = 0;
  uint32_t key_count = 0;
  uint32_t part_size = 0;
  View<const uint32_t> begins;
  View<uint32_t> offsets;  ///< counts of KeyTotalsKernel
  View<uint32_t> order;

  RELUME_HD void operator()(uint32_t part, uint32_t) const {
    uint32_t* const offsets_here = offsets.data + size_t{part} * key_count;
    for (uint32_t key = 0; key < key_count; ++key) offsets_here[key] += begins[key];
    const size_t begin = size_t{part} * part_size;
    const size_t end = begin + part_size < elements ? begin + part_size : elements;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t key = keys(i);
      if (key < key_count) order[offsets_here[key]++] = static_cast<uint32_t>(i);
    }
  }
};

/// Number of indices per part. The counts of all parts take at most as many words as the indices; in the host form an
/// eighth, because fewer threads need fewer parts. The order of the result does not depend on it.
inline uint32_t key_part_size(uint32_t key_count, KernelForm form) {
  const bool on_host = form == KernelForm::host;
  return std::max(on_host ? 8 * kPrimitiveBlock : kPrimitiveBlock,
                  static_cast<uint32_t>(std::min<uint64_t>((on_host ? 8 : 1) * uint64_t{key_count}, 1u << 31)));
}

/// Orders the indices [0, size) by keys(i). Indices with a key of `key_count` or more are left out. The order is that
/// of a stable sort, so it does not depend on threads. Returns false if `stop` was requested first; `groups` is then
/// incomplete.
template <typename Keys>
bool group_by_key(const PrimitiveLaunch& at, const Keys& keys, uint32_t size, uint32_t key_count, KeyGroups& groups,
                  const std::stop_token& stop = {}) {
  constexpr uint32_t kKeysPerTile = 1024;
  const uint32_t part_size = key_part_size(key_count, at.backend.form());
  const uint32_t parts = size / part_size + (size % part_size > 0 ? 1 : 0);
  const View<uint32_t> counts = at.scratch.counts(at.backend, size_t{parts} * key_count);
  const CountKeysKernel<Keys> count{keys, size, key_count, part_size, counts};
  if (!launch(at.backend, at.name, count, parts, 1, stop, 1)) return false;
  groups.begins.reset(size_t{key_count} + 1, kUninitialized);
  const View<uint32_t> begins = groups.begins.mutable_view();
  const KeyTotalsKernel totals{key_count, parts, counts, begins};
  if (!launch(at.backend, at.name, totals, begins.size, 1, stop, kKeysPerTile)) return false;
  const std::optional<uint64_t> total =
      exclusive_scan_or_stop(at, Elements<uint32_t>{{begins.data, begins.size}}, begins, stop);
  if (!total) return false;
  groups.order.reset(*total, kUninitialized);
  const OrderByKeyKernel<Keys> order{
      keys, size, key_count, part_size, groups.begins.view(), counts, groups.order.mutable_view()};
  return launch(at.backend, at.name, order, parts, 1, stop, 1);
}

}  // namespace relume
