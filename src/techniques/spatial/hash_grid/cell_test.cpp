#include "techniques/spatial/hash_grid/change.h"

#include <gtest/gtest.h>

#include <cstring>
#include <thread>
#include <vector>

#include "testing/random.h"

namespace relume {
namespace {

/// Moments by definition, in double precision.
struct BruteForce {
  glm::dvec3 sum{0};
  double square = 0;
  double weight = 0;
  double count = 0;

  void add(const Rgb& value, double w) {
    sum += glm::dvec3(value) * w;
    square += static_cast<double>(luminance(value)) * static_cast<double>(luminance(value)) * w;
    weight += w;
    count += 1;
  }
};

void expect_equal(const CellMoments& m, const BruteForce& b) {
  // Rounding error of the result in float: 2^-24.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.mean[c] / (b.sum[c] / b.weight), 1.0, 2e-7);
  EXPECT_NEAR(m.mean_square / (b.square / b.weight), 1.0, 2e-7);
  EXPECT_EQ(m.count, b.count);
}

TEST(CellSums, MatchBruteForce) {
  testing::Random random(1);
  CellSums sums;
  BruteForce expected;
  for (int i = 0; i < 20000; ++i) {
    const Rgb value(random.next(), 3.0f * random.next(), 0.1f * random.next());
    sums.add(value, 1.0f);
    expected.add(value, 1.0);
  }
  expect_equal(sums.moments(), expected);
}

TEST(CellSums, HoldSunlightAndDuskTogether) {
  // Squares from 1e-10 to 1e14 exceed the range of one 64-bit integer.
  testing::Random random(2);
  CellSums dusk;
  BruteForce expected_dusk;
  for (int i = 0; i < 1000; ++i) {
    const Rgb value = Rgb(1e-5f + 1e-5f * random.next());
    dusk.add(value, 1.0f);
    expected_dusk.add(value, 1.0);
  }
  for (int c = 0; c < 3; ++c) {  // the unit 2^-40 is 1e-7 of these values
    EXPECT_NEAR(dusk.moments().mean[c] / (expected_dusk.sum[c] / expected_dusk.weight), 1.0, 2e-7);
  }
  // The unit 2^-56 is 1.4e-7 of these squares.
  EXPECT_NEAR(dusk.moments().mean_square / (expected_dusk.square / expected_dusk.weight), 1.0, 3e-7);
  BruteForce expected_both = expected_dusk;
  for (int i = 0; i < 1000; ++i) {
    const Rgb value = Rgb(1e7f * random.next());
    dusk.add(value, 1.0f);
    expected_both.add(value, 1.0);
  }
  expect_equal(dusk.moments(), expected_both);
}

TEST(CellSums, CarryIntoTheUpperLimb) {
  CellSums sums;
  for (int i = 0; i < 1000; ++i) sums.add(Rgb(kCellSampleMax), 1.0f);
  EXPECT_GT(sums.high[0], 0u);
  EXPECT_GT(sums.square_high, 0u);
  EXPECT_EQ(sums.moments().mean, Rgb(kCellSampleMax));
  EXPECT_NEAR(sums.moments().mean_square / sqr(kCellSampleMax), 1.0, 1e-6);
}

TEST(CellSums, WeightSamples) {
  testing::Random random(3);
  CellSums sums;
  BruteForce expected;
  for (int i = 0; i < 5000; ++i) {
    const float weight = static_cast<float>(1 + i % 40) * 0.25f;  // multiples of the unit
    const Rgb value(random.next(), random.next(), random.next());
    sums.add(value, weight);
    expected.add(value, static_cast<double>(weight));
  }
  expect_equal(sums.moments(), expected);
}

TEST(CellSums, DoNotDependOnTheOrder) {
  testing::Random random(4);
  std::vector<Rgb> values(4000);
  for (Rgb& v : values) v = Rgb(std::exp2(40.0f * random.next() - 20.0f), random.next(), 100.0f * random.next());
  CellSums forward;
  CellSums together;
  for (const Rgb& v : values) forward.add(v, 1.0f);
  {
    std::vector<std::jthread> threads;
    for (size_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (size_t i = values.size() - 1 - t; i < values.size(); i -= 4) together.add(values[i], 1.0f);
      });
    }
  }
  EXPECT_EQ(std::memcmp(&forward, &together, sizeof(CellSums)), 0);
}

CellMoments constant(float value, float count) { return {Rgb(value), sqr(luminance(Rgb(value))), count}; }

TEST(CellMoments, VarianceIsUnbiased) {
  CellSums sums;
  for (const float v : {1.0f, 2.0f, 3.0f, 6.0f}) sums.add(Rgb(v), 1.0f);
  EXPECT_NEAR(sums.moments().variance(), 14.0 / 3.0, 1e-5);
  EXPECT_EQ(constant(2, 1).variance(), 0.0f);
}

TEST(CellHistory, PoolsFramesUpToTheMaximumCellSize) {
  const AveragingRule rule{16, 0, 1};
  CellHistory h = advanced({}, constant(1, 8), rule);
  EXPECT_EQ(h.moments.count, 8.0f);
  h = advanced(h, constant(4, 8), rule);
  EXPECT_FLOAT_EQ(h.moments.mean.r, 2.5f);
  EXPECT_EQ(h.moments.count, 16.0f);
  // The average is exponential from here: 16 of 24 samples are old.
  h = advanced(h, constant(0, 8), rule);
  EXPECT_FLOAT_EQ(h.moments.mean.r, 2.5f * 16.0f / 24.0f);
  EXPECT_EQ(h.moments.count, 16.0f);
  EXPECT_EQ(h.frames, 3u);
}

TEST(CellHistory, RestartsAfterTwoOutliersOnTheSameSide) {
  const AveragingRule rule{1e6f, 4, 4};
  testing::Random random(5);
  const auto frame = [&](float mean) {
    CellSums sums;
    for (int i = 0; i < 64; ++i) sums.add(Rgb(2.0f * mean * random.next()), 1.0f);
    return sums.moments();
  };
  CellHistory h;
  for (int i = 0; i < 200; ++i) h = advanced(h, frame(1), rule);
  EXPECT_GT(h.moments.count, 10000.0f);  // noise alone causes no restart
  h = advanced(h, frame(3), rule);
  EXPECT_NE(h.departure, 0);
  EXPECT_NEAR(h.moments.mean.r, 1.0f, 0.05f);
  h = advanced(h, frame(3), rule);
  EXPECT_EQ(h.moments.count, 64.0f);
  EXPECT_NEAR(h.moments.mean.r, 3.0f, 1.1f);  // five standard errors of 64 samples of standard deviation 1.73
}

TEST(CellHistory, PoolsSparseFramesUntilTheyAreSignificant) {
  const AveragingRule rule{1024, 4, 8};
  testing::Random random(7);
  const auto frame = [&](float mean) {
    CellSums sums;
    for (int i = 0; i < 2; ++i) sums.add(Rgb(2.0f * mean * random.next()), 1.0f);
    return sums.moments();
  };
  CellHistory h;
  for (int i = 0; i < 2000; ++i) h = advanced(h, frame(1), rule);
  EXPECT_EQ(h.moments.count, 1024.0f);
  // Windows have eight samples in four frames; the first may begin before the change. Two in a row must deviate by four
  // standard errors. The standard deviation is only 0.16 of the mean.
  const auto steady = [](float mean, int k) {
    CellSums sums;
    for (const float side : {-1.0f, 1.0f})
      sums.add(Rgb(mean * (1.0f + 0.1f * side * static_cast<float>(k % 2 + 1))), 1.0f);
    return sums.moments();
  };
  h = {};
  for (int i = 0; i < 2000; ++i) h = advanced(h, steady(1, i), rule);
  for (int i = 0; i < 16; ++i) h = advanced(h, steady(4, i), rule);
  EXPECT_LT(h.moments.count, 40.0f);
  EXPECT_NEAR(h.moments.mean.r, 4.0f, 0.1f);
}

TEST(CellHistory, OneOutlyingFrameIsNoChange) {
  const AveragingRule rule{1e6f, 4, 4};
  CellHistory h;
  for (int i = 0; i < 50; ++i) h = advanced(h, constant(1, 32), rule);
  h = advanced(h, constant(100, 32), rule);
  h = advanced(h, constant(1, 32), rule);
  EXPECT_GT(h.moments.count, 1000.0f);
}

TEST(CellHistory, DoesNotDriftOverManyFrames) {
  const AveragingRule rule{256, 4, 8};
  testing::Random random(6);
  CellHistory h;
  double mean = 0;
  constexpr int kFrames = 10000;
  for (int f = 0; f < kFrames; ++f) {
    CellSums sums;
    for (int i = 0; i < 8; ++i) sums.add(Rgb(random.next()), 1.0f);
    h = advanced(h, sums.moments(), rule);
    if (f >= kFrames / 2) mean += static_cast<double>(h.moments.mean.r) / (kFrames / 2);
  }
  // Five standard errors of 40,000 samples, whose standard deviation is 0.58 of the mean, are 1.5 %.
  EXPECT_NEAR(mean, 0.5, 0.5 * 0.015);
}

}  // namespace
}  // namespace relume
