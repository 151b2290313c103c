#include "techniques/spatial/hash_grid/discard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

#include "core/hash.h"

namespace relume {
namespace {

/// Cells in random slots; few ages, counts and buckets, so that every part of a key decides somewhere.
struct Cells {
  explicit Cells(uint32_t slots) {
    fingerprints.reset(slots);
    bucket_hashes.reset(slots);
    histories.reset(slots);
    for (uint32_t i = 0; i < slots; ++i) {
      if (hash(i, 1u) % 3 == 0) continue;
      fingerprints.write()[i] = (uint64_t{hash(i, 2u) % 2} << 40) + hash(i, 3u) % 4 + 1;
      bucket_hashes.write()[i] = i;
      histories.write()[i].age = hash(i, 4u) % 3 << 7;
      histories.write()[i].moments.count = static_cast<float>(hash(i, 5u) % 3);  // 0: an empty cell
    }
  }
  KeyedCells view() const { return {fingerprints.view(), bucket_hashes.view(), histories.view()}; }
  /// Slots of live cells, in the order in which they are kept.
  std::vector<uint32_t> kept_order() const {
    std::vector<uint32_t> slots;
    for (uint32_t i = 0; i < histories.size(); ++i)
      if (!histories.read()[i].empty()) slots.push_back(i);
    const auto key = [&](uint32_t i) {
      const CellHistory& cell = histories.read()[i];
      return std::tuple(cell.age, -cell.moments.count, fingerprints.read()[i], bucket_hashes.read()[i]);
    };
    std::sort(slots.begin(), slots.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    return slots;
  }

  Array<uint64_t> fingerprints;
  Array<uint32_t> bucket_hashes;
  Array<CellHistory> histories;
};

TEST(DiscardCells, EmptiesTheOldestCells) {
  for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
    Backend backend(2, form);
    const std::vector<uint32_t> order = Cells(5000).kept_order();
    ASSERT_GT(order.size(), 1000u);
    for (const size_t count : {size_t{1}, size_t{2}, size_t{777}, order.size() - 1, order.size()}) {
      Cells cells(5000);
      const DiscardKey threshold = discard_threshold(backend, "cells", cells.view(), count, host_memory());
      launch(backend, "cells", DiscardCellsKernel{cells.view(), threshold, cells.histories.mutable_view()}, 5000, 1);
      const std::set<uint32_t> kept(order.begin(), order.end() - static_cast<std::ptrdiff_t>(count));
      for (uint32_t i = 0; i < 5000; ++i)
        ASSERT_EQ(!cells.histories.read()[i].empty(), kept.count(i) == 1) << i << " of " << count;
    }
  }
}

TEST(DistinctKeys, AreCountedOnce) {
  const CellKeys keys = [] {
    CellKeys k;
    k.cone_spread = 1e-3f;
    return k;
  }();
  Array<WaitingSample> samples;
  samples.reset(20000);
  std::set<uint64_t> expected;
  for (uint32_t i = 0; i < samples.size(); ++i) {
    WaitingSample& sample = samples.write()[i];
    sample.point.position = Vec3(static_cast<float>(hash(i, 1u) % 50), 0, static_cast<float>(hash(i, 2u) % 50));
    sample.point.normal = hash(i, 3u) % 5;
    sample.coarser = static_cast<int>(hash(i, 4u) % 2);
    expected.insert(keys.address(sample.point, sample.coarser).fingerprint);
  }
  Backend backend(2);
  Array<uint64_t> set;
  EXPECT_EQ(distinct_keys(backend, "cells", samples.view(), keys, set), expected.size());
  EXPECT_EQ(distinct_keys(backend, "cells", {samples.view().data, 1}, keys, set), 1u);
  for (const uint32_t size : {1u, 2u, 1023u, 1024u, 1025u, 16384u}) {  // the set is half full of different keys
    expected.clear();
    for (uint32_t i = 0; i < size; ++i) {
      samples.write()[i].point.position = Vec3(static_cast<float>(i % 128), 0, static_cast<float>(i / 128));
      expected.insert(keys.address(samples.read()[i].point, samples.read()[i].coarser).fingerprint);
    }
    EXPECT_EQ(distinct_keys(backend, "cells", {samples.view().data, size}, keys, set), expected.size());
  }
}

}  // namespace
}  // namespace relume
