#include "core/lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>

namespace relume {
namespace {

template <size_t size>
std::array<float, size> counting() {
  std::array<float, size> values;
  std::iota(values.begin(), values.end(), 0.0f);
  return values;
}

TEST(Lanes, VectorsAndPairsAreSeparatedByComponent) {
  const auto vectors = counting<3 * kLanes>();
  Lanes v[3];
  load_vectors(vectors.data(), v);
  const auto pairs = counting<2 * kLanes>();
  Lanes p[2];
  load_pairs(pairs.data(), p);
  for (uint32_t i = 0; i < kLanes; ++i) {
    for (uint32_t c = 0; c < 3; ++c) EXPECT_EQ(v[c][i], vectors[3 * i + c]);
    for (uint32_t c = 0; c < 2; ++c) EXPECT_EQ(p[c][i], pairs[2 * i + c]);
  }
  std::array<float, 3 * kLanes> stored_vectors = {};
  store_vectors(stored_vectors.data(), v[0], v[1], v[2]);
  EXPECT_EQ(stored_vectors, vectors);
  std::array<float, 2 * kLanes> stored_pairs = {};
  store_pairs(stored_pairs.data(), p[0], p[1]);
  EXPECT_EQ(stored_pairs, pairs);
}

TEST(Lanes, RowsOfATableBecomeColumns) {
  const auto table = counting<kLanes * 20>();
  const uint32_t rows[kLanes] = {3, 19, 0, 7, 7, 12, 1, 18};
  Lanes columns[kLanes];
  load_rows(table.data(), rows, columns);
  for (uint32_t i = 0; i < kLanes; ++i) {
    for (uint32_t c = 0; c < kLanes; ++c) EXPECT_EQ(columns[c][i], table[kLanes * rows[i] + c]);
  }
}

TEST(Lanes, MasksFollowTheirCondition) {
  for (uint32_t set = 0; set <= kLanes; ++set) {
    const LaneMask mask = mask_of([&](uint32_t i) { return i + 1 == set; });
    EXPECT_EQ(any_of(mask), set > 0);
    const Lanes chosen = select(mask, Lanes(1.0f), Lanes(2.0f));
    for (uint32_t i = 0; i < kLanes; ++i) EXPECT_EQ(chosen[i], i + 1 == set ? 1.0f : 2.0f);
  }
}

}  // namespace
}  // namespace relume
