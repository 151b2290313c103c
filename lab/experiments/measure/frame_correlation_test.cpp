#include "experiments/measure/frame_correlation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "testing/random.h"

namespace relume {
namespace {

constexpr size_t kPixels = 64;
constexpr size_t kRuns = 24;
constexpr size_t kFrames = 120;

/// Moving averages of uniform numbers with ρ = 4/5; neighbouring pixels share half of their numbers.
std::vector<RunFrames> moving_averages() {
  testing::Random random(7);
  std::vector<RunFrames> runs;
  for (size_t r = 0; r < kRuns; ++r) {
    RunFrames run;
    std::vector<float> average(kPixels, 0.5f);
    for (size_t f = 0; f < kFrames + 40; ++f) {
      std::vector<float> fresh(kPixels + 1);
      for (float& value : fresh) value = random.next();
      for (size_t p = 0; p < kPixels; ++p) average[p] = 0.8f * average[p] + 0.1f * (fresh[p] + fresh[p + 1]);
      if (f >= 40) run.push_back(average);
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

TEST(FrameCorrelation, FallsAsInTheModel) {
  const std::vector<double> correlations = frame_correlations(moving_averages(), 0, 10);
  ASSERT_EQ(correlations.size(), 11u);
  for (size_t lag = 0; lag < 8; ++lag) EXPECT_NEAR(correlations[lag], std::pow(0.8, lag), 0.05) << lag;
}

TEST(FrameCorrelation, OfPixelsIsThatOfSharedNumbers) {
  std::vector<size_t> pixels;
  for (size_t p = 0; p < kPixels; ++p) pixels.push_back(p);
  const std::vector<double> correlations = pixel_correlations(moving_averages(), pixels, 16, 4);
  EXPECT_EQ(correlations[0], 1);
  EXPECT_NEAR(correlations[1], 0.5, 0.12);
  EXPECT_NEAR(correlations[2], 0, 0.15);
  EXPECT_NEAR(correlations[4], 0, 0.15);
}

TEST(VarianceByBlocks, ApproachesThatOverRuns) {
  const std::vector<RunFrames> runs = moving_averages();
  const double actual = variance_over_runs(run_means(runs, kFrames));
  // A frame varies by 1/24 · (1 − ρ) / (1 + ρ), and nine frames count as one, less 40 / 120 at the ends. The runs'
  // variance spreads by 5 %.
  EXPECT_NEAR(actual, (9 - 1.0 / 3) / kFrames / 24 / 9, 0.2 * actual);
  double single = 0;
  double blocks = 0;
  for (const RunFrames& run : runs) {
    single += variance_by_blocks(run, kFrames, 1) / kRuns;
    blocks += variance_by_blocks(run, kFrames, 30) / kRuns;
  }
  EXPECT_LT(single, 0.15 * actual);
  EXPECT_GT(blocks, 0.6 * actual);
  EXPECT_LT(blocks, 1.1 * actual);
}

}  // namespace
}  // namespace relume
