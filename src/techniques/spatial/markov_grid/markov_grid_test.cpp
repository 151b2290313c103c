#include "techniques/spatial/markov_grid/markov_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::point_at;

struct Number {
  uint32_t value = 0;
  float weight = 0;
};

MarkovGrid grid() { return testing::FilledTable<Number>().grid; }

const Vec3 kUp(0, 1, 0);

TEST(MarkovGrid, DrawsTheSameCellsAtTheSamePlaceInAFrame) {
  MarkovGrid g = grid();
  const SurfacePoint sp = point_at({1, 0.3f, -2}, kUp);
  const SurfacePoint other = point_at({1, 0.3f, std::nextafter(-2.0f, 0.0f)}, kUp);
  EXPECT_EQ(g.seed_at(sp), g.seed_at(sp));
  EXPECT_NE(g.seed_at(sp), g.seed_at(other));
  const uint32_t before = g.seed_at(sp);
  g.seed = 2;
  EXPECT_NE(g.seed_at(sp), before);
}

TEST(MarkovGrid, BothGridsHaveSlotsOfTheirOwn) {
  MarkovGrid g = grid();
  int adaptive = 0;
  constexpr uint32_t kDraws = 20000;
  for (uint32_t i = 0; i < kDraws; ++i) {
    const MarkovCell cell = g.drawn(point_at({1, 0.3f, -2}, kUp), 7, i);
    ASSERT_LT(cell.slot, g.adaptive_slots + g.static_slots);
    if (!g.is_static(cell)) ++adaptive;
  }
  const double expected = static_cast<double>(g.adaptive_share) * kDraws;
  EXPECT_NEAR(adaptive, expected, 5 * std::sqrt(expected * 0.3));
  g.adaptive_share = 0;
  for (uint32_t i = 0; i < 100; ++i) EXPECT_TRUE(g.is_static(g.drawn(point_at({1, 0.3f, -2}, kUp), 7, i)));
}

/// Number of draws of each cell.
template <typename Draw>
std::map<uint64_t, int> cells_of(const Draw& draw, uint32_t draws = 4000) {
  std::map<uint64_t, int> cells;
  for (uint32_t i = 0; i < draws; ++i) {
    const MarkovCell cell = draw(hash(i));
    ++cells[uint64_t{cell.slot} << 32 | cell.check];
  }
  return cells;
}

TEST(MarkovGrid, StaticCellsAreTheNearestEight) {
  const MarkovGrid g = grid();
  const auto cells = cells_of([&](uint32_t h) { return g.static_cell({0.4f, 0.3f, -0.2f}, h); });
  EXPECT_GT(cells.size(), 1u);
  EXPECT_LE(cells.size(), 8u);
}

TEST(MarkovGrid, EveryLevelHasHalfTheProbabilityOfTheOneBelow) {
  const MarkovGrid g = grid();
  const Vec3 p(3, 0.2f, 1);
  constexpr uint32_t kDraws = 16000;
  std::map<int, std::set<uint64_t>> cells;  // by raised levels
  std::map<int, int> draws;
  for (uint32_t i = 0; i < kDraws; ++i) {
    const uint32_t h = hash(i);
    int raised = 0;
    for (uint32_t bits = hash(h, MarkovGrid::kLevelNumber); raised < MarkovGrid::kMostRaisedLevels && (bits & 1u) != 0;
         bits >>= 1)
      ++raised;
    const MarkovCell cell = g.adaptive_cell(p, kUp, h);
    cells[raised].insert(uint64_t{cell.slot} << 32 | cell.check);
    ++draws[raised];
  }
  std::set<uint64_t> all;
  size_t sum = 0;
  for (const auto& [raised, of_level] : cells) {
    EXPECT_LE(of_level.size(), 8u) << raised;
    sum += of_level.size();
    all.insert(of_level.begin(), of_level.end());
  }
  EXPECT_EQ(all.size(), sum) << "levels share cells";
  for (int raised = 0; raised < 4; ++raised) {
    const double expected = kDraws / std::pow(2.0, raised + 1);
    EXPECT_NEAR(draws[raised], expected, 5 * std::sqrt(expected)) << raised;
  }
}

TEST(MarkovGrid, AdaptiveCellsDistinguishNormals) {
  const MarkovGrid g = grid();
  const Vec3 p(3, 0.2f, 1);
  int equal = 0;
  for (uint32_t i = 0; i < 1000; ++i) {
    const MarkovCell up = g.adaptive_cell(p, kUp, hash(i));
    const MarkovCell down = g.adaptive_cell(p, -kUp, hash(i));
    equal += up.slot == down.slot && up.check == down.check ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

TEST(MarkovGrid, NeighboursShareCells) {
  const MarkovGrid g = grid();
  const Vec3 p(3, 0.2f, 1);
  const float edge = g.edge_at(p);
  const auto here = cells_of([&](uint32_t h) { return g.adaptive_cell(p, kUp, h); });
  const auto near = cells_of([&](uint32_t h) { return g.adaptive_cell(p + Vec3(0.2f * edge, 0, 0), kUp, h + 1); });
  int shared = 0;
  for (const auto& [cell, count] : near) shared += here.contains(cell) ? count : 0;
  EXPECT_GT(shared, 2000);
  const auto far = cells_of([&](uint32_t h) { return g.adaptive_cell(p + Vec3(0, 0, 20 * edge), kUp, h); });
  shared = 0;
  for (const auto& [cell, count] : far) shared += here.contains(cell) ? count : 0;
  EXPECT_LT(shared, 800);  // in the coarsest cells
}

TEST(MarkovGrid, EdgesFollowTheFootprint) {
  const MarkovGrid g = grid();
  for (const float distance : {1.0f, 10.0f, 1000.0f}) {
    const float expected = g.keys.cell_size * g.keys.cone_spread * distance;
    EXPECT_GE(g.edge_at({distance, 0, 0}), 0.7f * expected);
    EXPECT_LE(g.edge_at({distance, 0, 0}), 1.42f * expected);
  }
}

TEST(MarkovTable, ReadsOnlyTheCellThatWrote) {
  testing::FilledTable<Number> table;
  const SurfacePoint sp = point_at({1, 0.3f, -2}, kUp);
  table.fill(sp, [](uint32_t number) { return Number{number, 1}; });
  const uint32_t seed = table.grid.seed_at(sp);
  std::set<uint32_t> slots;
  for (uint32_t i = 0; i < table.grid.drawn_cells; ++i) {
    MarkovCell cell = table.grid.drawn(sp, seed, i);
    slots.insert(cell.slot);
    EXPECT_EQ(table.view().load(cell).weight, 1.0f);
    ++cell.check;
    EXPECT_EQ(table.view().load(cell).weight, 0.0f);
    EXPECT_EQ(table.view().load({kNoSlot, 0}).weight, 0.0f);
  }
  EXPECT_GT(slots.size(), 1u);
}

}  // namespace
}  // namespace relume
