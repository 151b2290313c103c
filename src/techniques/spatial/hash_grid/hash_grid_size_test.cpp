// The size of the table: limits, growth, cleaning and checkpoints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/spatial/hash_grid/testing/grid_camera.h"

namespace relume {
namespace {

HashGridSettings with_limit(int max_cells) {
  HashGridSettings s;
  s.undersampled_cells = UndersampledCells::keep;
  s.change_detection = 0;
  s.max_cells = max_cells;
  return s;
}

/// Adds one sample to each of `count` cells, starting at cell `first`.
void fill(HashGrid& grid, int first, int count) {
  const HashGridView v = grid.view(grid_camera());
  for (int i = first; i < first + count; ++i) {
    CellPoint p;
    p.position = Vec3(0, 0, 2);
    p.normal = 1u + static_cast<uint32_t>(i % 64);
    const float edge = std::exp2(static_cast<float>(v.keys.level_of_detail(p.position)));
    p.position.x = edge * static_cast<float>(i / 64 % 16);
    p.position.y = edge * static_cast<float>(i / 1024);
    v.insert(p, Rgb(1), 1.0f, 0.5f);
  }
}

TEST(HashGridSize, CleansAFullTableOfItsLargestSize) {
  HashGridSettings settings = with_limit(kMaxProbes);
  settings.max_age = 1;
  HashGrid grid(settings, 1);
  Backend backend(1);
  fill(grid, 0, 75);
  grid.end_frame(backend);
  for (int frame = 0; frame < 4; ++frame) {  // 75 cells are evicted, 105 live: less than half of the keys are dead
    fill(grid, 75, 105);
    grid.end_frame(backend);
  }
  EXPECT_EQ(grid.statistics().cells, 105u);
  fill(grid, 180, 100);  // 280 keys, but 205 cells
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().cells, 205u);
  EXPECT_EQ(grid.statistics().discarded, 0u);
  EXPECT_EQ(grid.statistics().slots, kMaxProbes);
}

TEST(HashGridSize, AFrameMayHaveMoreCellsThanTheTableKeeps) {
  HashGrid grid(with_limit(256), 1);
  Backend backend(1);
  fill(grid, 0, 1000);
  grid.advance(backend);
  EXPECT_EQ(grid.statistics().cells, 1000u);
  EXPECT_EQ(grid.statistics().samples, 1000u);
  EXPECT_GT(grid.statistics().slots, 1000u);
  grid.adjust_size(backend);
  EXPECT_EQ(grid.statistics().cells, 224u);  // seven eighths
  EXPECT_EQ(grid.statistics().discarded, 776u);
  EXPECT_EQ(grid.statistics().slots, 256u);
  EXPECT_EQ(grid.statistics().dropped, 0u);
}

TEST(HashGridSize, AnAbandonedFrameLeavesNeitherSamplesNorKeys) {
  HashGrid grid(with_limit(4096), 1);
  Backend backend(1);
  fill(grid, 0, 200);
  grid.end_frame(backend);
  const HashGridStatistics before = grid.statistics();
  fill(grid, 100, 3000);
  grid.abandon_frame();
  grid.adjust_size(backend);
  EXPECT_EQ(grid.statistics().cells, before.cells);
  EXPECT_EQ(grid.statistics().slots, before.slots);
  const HashGridView v = grid.view(grid_camera());
  EXPECT_EQ(std::count(v.fingerprints.begin(), v.fingerprints.end(), 0u), static_cast<ptrdiff_t>(before.slots - 200));
  fill(grid, 0, 200);
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().samples, 200u) << "of this frame alone";
  EXPECT_EQ(grid.statistics().cells, 200u);
}

ptrdiff_t keys_in(HashGrid& grid) {
  const HashGridView v = grid.view(grid_camera());
  return v.fingerprints.size - std::count(v.fingerprints.begin(), v.fingerprints.end(), 0u);
}

TEST(HashGridSize, AnAbandonedFrameWithoutNewKeysRebuildsNothing) {
  HashGridSettings settings = with_limit(4096);
  settings.max_age = 1;
  HashGrid grid(settings, 1);
  Backend backend(1);
  fill(grid, 0, 200);
  grid.end_frame(backend);
  for (int frame = 0; frame < 4; ++frame) {
    fill(grid, 100, 100);
    grid.end_frame(backend);
  }
  ASSERT_EQ(grid.statistics().cells, 100u);
  ASSERT_EQ(keys_in(grid), 200) << "evicted cells keep their slots until a rebuild";
  for (const int count : {0, 100}) {
    fill(grid, 100, count);
    grid.abandon_frame();
    grid.adjust_size(backend);
    EXPECT_EQ(keys_in(grid), 200) << count;
  }
  fill(grid, 100, 50);
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().samples, 50u) << "of this frame alone";
}

TEST(HashGridSize, SavesNothingOfAnAbandonedFrame) {
  HashGrid grid(with_limit(4096), 1);
  Backend backend(1);
  fill(grid, 0, 200);
  grid.end_frame(backend);
  for (int attempt = 0; attempt < 2; ++attempt) {
    fill(grid, 100, 1000);
    grid.abandon_frame();
  }
  HashGrid loaded(with_limit(4096), 1);
  ASSERT_TRUE(loaded.load(grid.save()));
  EXPECT_EQ(loaded.statistics().cells, 200u);
  EXPECT_EQ(keys_in(loaded), 200);
  for (HashGrid* each : {&grid, &loaded}) {
    each->adjust_size(backend);
    fill(*each, 0, 300);
    each->end_frame(backend);
    EXPECT_EQ(each->statistics().samples, 300u);
    EXPECT_EQ(each->statistics().cells, 300u);
  }
}

TEST(HashGridSize, DiscardsTheOldestCells) {
  HashGrid grid(with_limit(256), 1);
  Backend backend(1);
  fill(grid, 0, 200);
  grid.end_frame(backend);
  fill(grid, 100, 200);  // 0 to 99 have no sample in this frame
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().cells, 224u);
  EXPECT_EQ(grid.statistics().discarded, 76u);
  fill(grid, 100, 200);
  grid.end_frame(backend);
  const HashGridView v = grid.view(grid_camera());
  uint32_t twice = 0;
  for (uint32_t i = 0; i < v.histories.size; ++i) twice += v.histories[i].frames >= 2 ? 1u : 0u;
  EXPECT_EQ(twice, 200u);
}

TEST(HashGridSize, SamplesWithoutMemoryAreDroppedAndCounted) {
  HashGrid grid(with_limit(64), 1, HashGridBounds{.slots = 64, .memory_slots = 128});
  Backend backend(1);
  fill(grid, 0, 1000);
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().samples, 128u);
  EXPECT_EQ(grid.statistics().dropped, 872u);
  HashGrid hasty(with_limit(64), 1, HashGridBounds{.samples_a_frame = 100});  // length of the waiting list
  fill(hasty, 0, 1000);
  hasty.end_frame(backend);
  EXPECT_EQ(hasty.statistics().samples, 164u);
  EXPECT_EQ(hasty.statistics().dropped, 836u);
}

TEST(HashGridSize, AppliesALoweredLimit) {
  HashGrid grid(with_limit(1 << 16), 4000);
  Backend backend(1);
  fill(grid, 0, 3000);
  grid.end_frame(backend);
  EXPECT_GT(grid.statistics().slots, 4096u);
  grid.configure(with_limit(4096));
  grid.adjust_size(backend);
  EXPECT_EQ(grid.statistics().slots, 4096u);
  EXPECT_EQ(grid.statistics().cells, 3000u);
  grid.clear();
  EXPECT_EQ(grid.statistics().slots, 4096u);
  // A saved state can be loaded.
  HashGrid other(with_limit(4096), 64);
  EXPECT_TRUE(other.load(grid.save()));
  grid.configure(with_limit(1 << 16));  // and grows again
  fill(grid, 0, 3000);
  grid.end_frame(backend);
  EXPECT_GT(grid.statistics().slots, 4096u);
}

// Otherwise each sample without a slot would probe the whole table, as would each later look-up.
TEST(HashGridSize, FullTablesAreSearchedBriefly) {
  HashGrid grid(with_limit(64), 1, HashGridBounds{.slots = 64, .memory_slots = 1 << 16});
  Backend backend(1);
  fill(grid, 0, 1 << 17);
  grid.advance(backend);
  EXPECT_EQ(grid.statistics().samples + grid.statistics().dropped, 1u << 17);
  EXPECT_GT(grid.statistics().samples, 60'000u);
  EXPECT_LE(grid.view(grid_camera()).probe_limit, 4 * kMaxProbes);
}

TEST(HashGridSize, LoadsMoreCellsThanItKeeps) {
  HashGrid grid(with_limit(1 << 16), 4000);
  Backend backend(1);
  fill(grid, 0, 3000);
  grid.end_frame(backend);
  HashGrid small(with_limit(1024), 64);
  ASSERT_TRUE(small.load(grid.save()));
  EXPECT_EQ(small.statistics().cells, 3000u);
  small.adjust_size(backend);
  EXPECT_EQ(small.statistics().slots, 1024u);
  EXPECT_EQ(small.statistics().cells, 896u);
  EXPECT_EQ(small.statistics().discarded, 2104u);
}

TEST(HashGridSize, RejectsCheckpointsWithFalseSizes) {
  HashGrid grid(with_limit(4096), 64);
  const std::vector<std::byte> bytes = grid.save();
  const auto lie = [&](size_t offset, auto value) {
    std::vector<std::byte> other = bytes;
    std::memcpy(other.data() + offset, &value, sizeof(value));
    return other;
  };
  EXPECT_TRUE(grid.load(lie(0, uint32_t{1024})));
  EXPECT_FALSE(grid.load(lie(0, uint32_t{0})));
  EXPECT_FALSE(grid.load(lie(0, uint32_t{0xffffffff})));
  EXPECT_FALSE(grid.load(lie(sizeof(uint32_t), ~uint64_t{0})));
  Backend backend(1);
  fill(grid, 0, 2);
  grid.end_frame(backend);
  std::vector<std::byte> twice = grid.save();
  const size_t cell_bytes = (twice.size() - bytes.size()) / 2;
  std::copy_n(twice.end() - static_cast<std::ptrdiff_t>(cell_bytes), cell_bytes,
              twice.begin() + static_cast<std::ptrdiff_t>(bytes.size()));
  EXPECT_FALSE(grid.load(twice));  // the same cell
  EXPECT_EQ(grid.statistics().cells, 2u);
  // With any expected number of cells, an empty table has slots, and no more than the limit.
  for (const uint64_t expected : {uint64_t{0}, uint64_t{1} << 28}) {
    ASSERT_TRUE(grid.load(lie(sizeof(uint32_t), expected)));
    grid.clear();
    EXPECT_GE(grid.statistics().slots, 1024u);
    EXPECT_LE(grid.statistics().slots, 4096u);
    fill(grid, 0, 10);
  }
}

TEST(HashGridSize, LoadsSavedCellsWithAnyExpectedNumber) {
  HashGrid grid(with_limit(4096), uint64_t{kMostSlots} * 4);  // a large image of small cells and long paths
  Backend backend(1);
  fill(grid, 0, 100);
  grid.end_frame(backend);
  HashGrid other(with_limit(4096), 64);
  ASSERT_TRUE(other.load(grid.save()));
  EXPECT_EQ(other.statistics().cells, 100u);
}

TEST(HashGridSize, AnOpenLimitFollowsTheImageWithinTheMemory) {
  constexpr uint64_t kPixels4K = 3840 * 2160;
  constexpr uint64_t kRoomy = uint64_t{1} << 40;
  const auto slots = [](uint64_t pixels, uint64_t depths, uint64_t memory_bytes) {
    return bounds_for(pixels, depths, memory_bytes).slots;
  };
  // 1.5 cells per pixel, as path graphs have in Sponza, leave a table for 4K half empty.
  EXPECT_GE(slots(kPixels4K, 7, kRoomy), 3 * kPixels4K);
  EXPECT_EQ(slots(kPixels4K, 2, kRoomy), 2 * slots(kPixels4K, 1, kRoomy));
  EXPECT_LE(slots(kPixels4K, 64, kRoomy), uint64_t{kMostSlots});
  EXPECT_LE(132 * bounds_for(kPixels4K, 7, uint64_t{16} << 30).memory_slots, uint64_t{2} << 30);
  EXPECT_GE(slots(1, 1, 0), 1u);
  HashGrid grid(with_limit(0), 64, {.slots = 5000});
  EXPECT_EQ(grid.limit(), 5000u);
  grid.configure(with_limit(300), {.slots = 5000});  // the setting takes precedence
  EXPECT_EQ(grid.limit(), 300u);
}

}  // namespace
}  // namespace relume
