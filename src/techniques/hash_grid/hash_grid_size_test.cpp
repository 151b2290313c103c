// The size of the table: limits, growth, cleaning, and what checkpoints say about it.
#include <gtest/gtest.h>

#include <cstring>

#include "techniques/hash_grid/hash_grid_table.h"
#include "techniques/hash_grid/testing/grid_camera.h"

namespace relume {
namespace {

HashGridSettings with_limit(int max_cells) {
  HashGridSettings s;
  s.thin_cells = ThinCells::keep;
  s.change_detection = 0;
  s.max_cells = max_cells;
  return s;
}

/// One sample for each of `count` cells, from the cell numbered `first` on.
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

// A table of as many slots as are probed, so that it can be filled to the last.
TEST(HashGridSize, CleansAFullTableOfItsLargestSize) {
  HashGridSettings settings = with_limit(kMaxProbes);
  settings.max_age = 1;
  HashGrid grid(settings, 1);
  Backend backend(1);
  fill(grid, 0, 75);
  grid.end_frame(backend);
  for (int frame = 0; frame < 4; ++frame) {  // the first 75 die, 105 live: less than half of the keys are dead
    fill(grid, 75, 105);
    grid.end_frame(backend);
  }
  EXPECT_EQ(grid.statistics().cells, 105u);
  fill(grid, 180, 100);  // 280 keys, but 205 cells
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().dropped, 0u);
  EXPECT_EQ(grid.statistics().slots, kMaxProbes);
}

TEST(HashGridSize, CleansAfterDropsEvenForFewDeadCells) {
  HashGridSettings settings = with_limit(kMaxProbes);
  settings.max_age = 1;
  HashGrid grid(settings, 1);
  Backend backend(1);
  fill(grid, 0, 20);
  grid.end_frame(backend);
  for (int frame = 0; frame < 4; ++frame) {
    fill(grid, 20, 250);  // with the 20, too many
    grid.end_frame(backend);
  }
  const uint64_t dropped = grid.statistics().dropped;
  EXPECT_GT(dropped, 0u);
  fill(grid, 20, 250);
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().dropped, dropped);
  EXPECT_EQ(grid.statistics().cells, 250u);
}

TEST(HashGridSize, KeepsToALimitThatWasLowered) {
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
  // What it saves it can load.
  HashGrid other(with_limit(4096), 64);
  EXPECT_TRUE(other.load(grid.save()));
  grid.configure(with_limit(1 << 16));  // and grows again
  fill(grid, 0, 3000);
  grid.end_frame(backend);
  EXPECT_GT(grid.statistics().slots, 4096u);
}

TEST(HashGridSize, CountsTheCellsThatFindNoRoomWhenLoaded) {
  HashGrid grid(with_limit(1 << 16), 4000);
  Backend backend(1);
  fill(grid, 0, 3000);
  grid.end_frame(backend);
  HashGrid small(with_limit(1024), 64);
  ASSERT_TRUE(small.load(grid.save()));
  const HashGridStatistics s = small.statistics();
  EXPECT_EQ(s.slots, 1024u);
  EXPECT_EQ(s.cells + s.dropped, 3000u);
  EXPECT_GT(s.cells, 512u);
}

TEST(HashGridSize, DoesNotBelieveCheckpointsThatLieAboutSizes) {
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
  // Whatever the guess at the number of cells, an empty table has slots, and no more than the limit.
  for (const uint64_t expected : {uint64_t{0}, uint64_t{1} << 28}) {
    ASSERT_TRUE(grid.load(lie(sizeof(uint32_t), expected)));
    grid.clear();
    EXPECT_GE(grid.statistics().slots, 1024u);
    EXPECT_LE(grid.statistics().slots, 4096u);
    fill(grid, 0, 10);
  }
}

TEST(HashGridSize, LoadsWhatItSavesHoweverManyCellsAreExpected) {
  HashGrid grid(with_limit(4096), uint64_t{kMostSlots} * 4);  // a large picture of small cells and long paths
  Backend backend(1);
  fill(grid, 0, 100);
  grid.end_frame(backend);
  HashGrid other(with_limit(4096), 64);
  ASSERT_TRUE(other.load(grid.save()));
  EXPECT_EQ(other.statistics().cells, 100u);
}

TEST(HashGridSize, AnOpenLimitFollowsThePictureWithinTheMemory) {
  constexpr uint64_t kPixels4K = 3840 * 2160;
  constexpr uint64_t kRoomy = uint64_t{1} << 40;
  // 1.5 cells a pixel, as path graphs have in Sponza, leave a table for 4K half empty.
  EXPECT_GE(open_slot_limit(kPixels4K, 7, kRoomy), 3 * kPixels4K);
  EXPECT_EQ(open_slot_limit(kPixels4K, 2, kRoomy), 2 * open_slot_limit(kPixels4K, 1, kRoomy));
  EXPECT_LE(open_slot_limit(kPixels4K, 64, kRoomy), uint64_t{kMostSlots});
  EXPECT_LE(132 * open_slot_limit(kPixels4K, 7, uint64_t{16} << 30), uint64_t{2} << 30);
  EXPECT_GE(open_slot_limit(1, 1, 0), 1u);
  HashGrid grid(with_limit(0), 64, 5000);
  EXPECT_EQ(grid.limit(), 5000u);
  grid.configure(with_limit(300), 5000);  // a limit that is set wins
  EXPECT_EQ(grid.limit(), 300u);
}

}  // namespace
}  // namespace relume
