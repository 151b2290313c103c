#include "techniques/spatial/hash_grid/change.h"

#include <gtest/gtest.h>

#include <vector>

#include "testing/random.h"

namespace relume {
namespace {

/// The cells of a region with independent samples.
class Region {
 public:
  Region(int cells, int samples, uint32_t seed)
      : histories_(static_cast<size_t>(cells)), samples_(samples), random_(seed) {}

  /// Adds a frame whose samples in cell k are uniform between 0 and 2 mean(k). Returns the excess.
  template <typename Mean>
  float render(const Mean& mean) {
    std::vector<CellMoments> frame;
    RegionChange change;
    for (size_t k = 0; k < histories_.size(); ++k) {
      CellSums sums;
      for (int i = 0; i < samples_; ++i) sums.add(Rgb(2.0f * mean(k) * random_.next()), 1.0f);
      frame.push_back(sums.moments());
      const CellMoments window = pooled(histories_[k].recent, frame.back(), kInfinity);
      if (histories_[k].moments.count >= rule_.min_count && window.count >= rule_.min_count)
        change.add(squared_departure(histories_[k].moments, window));
    }
    const float excess = change.excess(kRegionThreshold * rule_.change_threshold);
    for (size_t k = 0; k < histories_.size(); ++k) histories_[k] = advanced(histories_[k], frame[k], rule_, excess);
    return excess;
  }
  float mean(size_t k) const { return histories_[k].moments.mean.r; }

 private:
  std::vector<CellHistory> histories_;
  int samples_;
  testing::Random random_;
  AveragingRule rule_{1024, 4, 8};
};

float one(size_t) { return 1; }

TEST(RegionChange, ChanceIsRarelyTakenForAChange) {
  for (const int samples : {1, 4, 64}) {
    Region region(64, samples, 3);
    int alarms = 0;
    for (int i = 0; i < 500; ++i) alarms += region.render(one) > 0 ? 1 : 0;
    EXPECT_LT(alarms, 0.14 * 500) << samples;  // the bound is exp(−2) per frame
  }
}

TEST(RegionChange, ARegionDetectsChangesTooSmallForOneCell) {
  Region region(64, 64, 4);
  for (int i = 0; i < 50; ++i) region.render(one);
  // Half of the cells become brighter, half darker by a quarter, 3.5 standard errors of a frame's 64 samples. None
  // leaves its confidence interval, and the mean of the region is unchanged.
  const auto changed = [](size_t k) { return k % 2 == 0 ? 1.25f : 0.75f; };
  EXPECT_GT(region.render(changed), 1.0f);
  for (int i = 0; i < 3; ++i) region.render(changed);
  double missing = 0;
  for (size_t k = 0; k < 64; ++k) missing += static_cast<double>(std::fabs(region.mean(k) - changed(k))) / 64;
  // Averaging four frames would leave four fifths of the quarter. The standard error of 256 samples is 0.036.
  EXPECT_LT(missing, 0.08);
}

TEST(RegionChange, TwoOutlyingFramesOfOneCellAreAChange) {
  Region region(1, 64, 5);
  for (int i = 0; i < 50; ++i) region.render(one);
  for (int i = 0; i < 2; ++i) region.render([](size_t) { return 3.0f; });
  EXPECT_NEAR(region.mean(0), 3.0f, 1.1f);  // five standard errors
}

TEST(CellHistory, RecordsWhetherItsLatestWindowDeparted) {
  const AveragingRule rule{1024, 4, 8};
  const auto frame = [](float mean) { return CellMoments{Rgb(mean), 1.01f * sqr(luminance(Rgb(mean))), 16}; };
  CellHistory h;
  for (int i = 0; i < 16; ++i) h = advanced(h, frame(1), rule);
  EXPECT_EQ(h.changed, 0);
  EXPECT_EQ(advanced(h, frame(2), rule).changed, 1);
  EXPECT_EQ(advanced(h, frame(1), rule, 0.5f).changed, 1);  // its region changed
  h = advanced(h, frame(2), rule);
  EXPECT_EQ(advanced(h, frame(2), rule).moments.count, 16.0f);
  EXPECT_EQ(advanced(h, frame(2), rule).changed, 1);
  EXPECT_EQ(advanced(h, frame(1), rule).changed, 0);
}

TEST(RegionChange, DiscountedCountMatchesTheError) {
  CellMoments history;
  history.count = 1000;
  CellMoments window;
  window.count = 50;
  // An error as large as the noise of 50 samples leaves a count of about 50.
  EXPECT_NEAR(discounted(history, window, 1).count, 1.0f / (1.0f / 1000 + 1.0f / 50 + 1.0f / 1000), 1e-3f);
  EXPECT_LT(discounted(history, window, 8).count, 7.0f);
}

/// The history after a frame with two samples of `value`.
CellHistory after_frame(const CellHistory& history, float value, const AveragingRule& rule) {
  CellSums sums;
  for (int i = 0; i < 2; ++i) sums.add(Rgb(value), 1.0f);
  return advanced(history, sums.moments(), rule);
}

TEST(FrameLimit, ALightThatGoesOutFadesExponentially) {
  const AveragingRule rule{1 << 24, 0, 1, 4};
  CellHistory cell;
  for (int i = 0; i < 100; ++i) cell = after_frame(cell, 1, rule);
  EXPECT_EQ(cell.frames, 8u);
  EXPECT_NEAR(cell.moments.count, 10.0f, 1e-3f);  // 2 (F + 1)
  float expected = 1;
  for (int i = 0; i < 8; ++i) {
    cell = after_frame(cell, 0, rule);
    expected *= 4.0f / 5.0f;
    EXPECT_NEAR(cell.moments.mean.r, expected, 1e-5f) << i;
  }
}

TEST(FrameLimit, FramesWithoutSamplesCount) {
  const AveragingRule rule{1 << 24, 0, 1, 4};
  CellHistory cell;
  for (int i = 0; i < 100; ++i) cell = after_frame(cell, 1, rule);
  cell.age = 4;  // as MaintainCellsKernel counts them
  cell = after_frame(cell, 0, rule);
  const float kept = 10.0f * 4.0f / 9.0f;
  EXPECT_NEAR(cell.moments.mean.r, kept / (kept + 2), 1e-5f);
  EXPECT_EQ(cell.age, 0u);
}

/// With a window of half its frames, frame k of a young cell weighs k + 1, and the first one 1.5.
TEST(FrameLimit, YoungCellsForgetTheirFirstSamples) {
  const AveragingRule rule{1 << 24, 0, 1, 32};
  CellHistory cell;
  for (int i = 0; i < 64; ++i) cell = after_frame(cell, i < 8 ? 0.0f : 1.0f, rule);
  EXPECT_NEAR(cell.moments.mean.r, 1.0f - 43.5f / 2143.5f, 1e-4f);
  EXPECT_NEAR(cell.moments.count, 2.0f * 2143.5f / 65.0f, 1e-2f);
}

TEST(FrameLimit, CellsAreKnownAsEarlyAsWithoutForgetting) {
  const AveragingRule rule{1 << 24, 0, 8, 32};
  CellHistory cell;
  for (int i = 0; i < 4; ++i) cell = after_frame(cell, 1, rule);
  EXPECT_EQ(cell.moments.count, 8.0f);
  for (int i = 0; i < 2; ++i) cell = after_frame(cell, 1, rule);
  EXPECT_LT(cell.moments.count, 11.0f);  // of 12 samples
  EXPECT_GE(cell.moments.count, 10.0f);
}

/// An inherited history counts no frames.
TEST(FrameLimit, InheritedSamplesFadeFromTheSecondFrame) {
  const AveragingRule rule{1 << 24, 0, 1, 32};
  CellHistory cell;
  cell.moments.count = 128;
  cell = after_frame(cell, 1, rule);
  EXPECT_EQ(cell.moments.count, 130.0f);
  cell = after_frame(cell, 1, rule);
  EXPECT_EQ(cell.moments.count, 67.0f);
}

}  // namespace
}  // namespace relume
