// Tests where camera paths end, and how much light of later vertices cells receive.
#include "techniques/radiance_cache/sharc/cell_ends.h"

#include <gtest/gtest.h>

#include "techniques/radiance_cache/sharc/cell_update.h"

namespace relume {
namespace {

TEST(SharcGuards, HideCellsSmallerThanSegmentAndCone) {
  EXPECT_TRUE(hides(2, 3, 1));
  EXPECT_TRUE(hides(1, 1, 1));
  EXPECT_FALSE(hides(0.9f, 3, 1));
  EXPECT_FALSE(hides(2, 0.9f, 1));
  EXPECT_FALSE(hides(2, 0, 1));  // seen directly or in a mirror
}

TEST(SharcGuards, ConesAreThoseOfTheLobes) {
  EXPECT_EQ(lobe_spread(0), 0.0f);
  EXPECT_NEAR(lobe_spread(0.1f), 0.0710669f, 1e-6f);  // √(0.005 / 0.99)
  EXPECT_NEAR(lobe_spread(0.5f), 0.408248f, 1e-5f);   // √(0.125 / 0.75)
  EXPECT_EQ(lobe_spread(1), 1000.0f);                 // diffuse
}

/// A cell of mean 1.
CellMoments cell_of(float variance, float count) {
  CellMoments cell;
  cell.mean = Rgb(1);
  cell.mean_square = sqr(luminance(cell.mean)) + variance * (count - 1) / count;
  cell.count = count;
  return cell;
}

TEST(CellEnds, KnownCellsEndPaths) {
  CellEnds ends;
  ends.cells.grid.rule.min_count = 4;
  EXPECT_FALSE(ends.accepts({}));
  EXPECT_FALSE(ends.accepts(cell_of(0, 3)));
  EXPECT_TRUE(ends.accepts(cell_of(0, 4)));
  EXPECT_TRUE(ends.accepts(cell_of(100, 4)));
}

TEST(CellEnds, LargeVarianceKeepsPathsAlive) {
  CellEnds ends;
  ends.by_variance = true;
  ends.variance = 0.5f;
  EXPECT_TRUE(ends.accepts(cell_of(0.4f, 100)));
  EXPECT_FALSE(ends.accepts(cell_of(0.6f, 100)));
  EXPECT_FALSE(ends.accepts(cell_of(0.4f, 15))) << "too few samples to know the variance";
  CellMoments bright = cell_of(0.4f, 100);
  bright.mean *= 10.0f;
  bright.mean_square *= 100.0f;
  EXPECT_TRUE(ends.accepts(bright)) << "the variance is relative";
  CellMoments black;
  black.count = 100;
  EXPECT_FALSE(ends.accepts(black)) << "bright samples may be rare";
}

TEST(SharcClamp, LimitsRiseWithConfidence) {
  EXPECT_EQ(clamped_share(10, cell_of(0, 2), 1000), 1.0f);
  EXPECT_NEAR(clamped_share(10, cell_of(0, 2.001f), 20), 0.25f, 1e-3f);  // 5 · mean
  EXPECT_NEAR(clamped_share(10, cell_of(0, 7), 15), 0.5f, 1e-6f);        // 7.5 · mean
  EXPECT_NEAR(clamped_share(10, cell_of(0, 12), 20), 0.5f, 1e-6f);       // 10 · mean
  EXPECT_EQ(clamped_share(10, cell_of(0, 500), 9.9f), 1.0f);
  CellMoments black;
  black.count = 100;
  EXPECT_EQ(clamped_share(10, black, 20), 1.0f) << "a black cell must be able to recover";
}

TEST(CellUpdates, BlocksCoverTheImage) {
  EXPECT_EQ(update_blocks(25, kUpdateBlock), 5u);
  EXPECT_EQ(update_blocks(26, kUpdateBlock), 6u);
  EXPECT_EQ(update_blocks(26, 1), 26u);
}

}  // namespace
}  // namespace relume
