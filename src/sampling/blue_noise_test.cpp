#include "sampling/blue_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/vec.h"
#include "sampling/sample_index.h"

namespace relume {
namespace {

constexpr uint32_t kEdge = kBlueNoiseEdge;

/// Mean power of the frequencies between two radii, in cycles per tile, of a map of kEdge² values with mean 0.
double power_between(const std::vector<double>& values, double least, double most) {
  double power = 0;
  int count = 0;
  constexpr int kHalf = static_cast<int>(kEdge) / 2;
  for (int v = -kHalf; v < kHalf; ++v) {
    for (int u = 0; u < kHalf; ++u) {
      const double radius = std::hypot(u, v);
      if (radius < least || radius > most) continue;
      std::complex<double> sum = 0;
      for (uint32_t y = 0; y < kEdge; ++y) {
        for (uint32_t x = 0; x < kEdge; ++x) {
          const double phase = -2 * M_PI * (u * static_cast<double>(x) + v * static_cast<double>(y)) / kEdge;
          sum += values[y * kEdge + x] * std::polar(1.0, phase);
        }
      }
      power += std::norm(sum);
      ++count;
    }
  }
  return power / count;
}

TEST(BlueNoise, HoldsEachRankOnce) {
  const View<const uint16_t> tile = blue_noise_tile();
  ASSERT_EQ(tile.size, kEdge * kEdge);
  std::vector<int> seen(tile.size);
  for (const uint16_t rank : tile) ++seen.at(rank);
  for (const int count : seen) EXPECT_EQ(count, 1);
}

TEST(BlueNoise, HasLittlePowerAtLowFrequencies) {
  std::vector<double> values;
  for (const uint16_t rank : blue_noise_tile()) values.push_back(rank / double{kEdge * kEdge} - 0.5);
  // White noise has the same power everywhere.
  EXPECT_LT(power_between(values, 1, 6), 0.02 * power_between(values, 24, 32));
}

/// Error at each pixel of one sample per pixel of a smooth function of two of its numbers.
std::vector<double> errors(bool dither, uint32_t seed) {
  const SampleIndex index{.seed = seed, .tile = dither ? blue_noise_tile() : View<const uint16_t>{}};
  std::vector<double> result;
  double mean = 0;
  for (uint32_t y = 0; y < kEdge; ++y) {
    for (uint32_t x = 0; x < kEdge; ++x) {
      Sampler sampler = index.sampler(x, y);
      sampler.start_dimension(3);
      const Vec2 u = sampler.next_2d();
      result.push_back(u.x * u.x + u.y);
      mean += result.back() / (kEdge * kEdge);
    }
  }
  for (double& value : result) value -= mean;
  return result;
}

TEST(Dithering, MovesErrorsToHighFrequencies) {
  double dithered = 0;
  double white = 0;
  for (uint32_t seed = 0; seed < 4; ++seed) {
    dithered += power_between(errors(true, seed), 1, 6);
    white += power_between(errors(false, seed), 1, 6);
  }
  EXPECT_LT(dithered, 0.15 * white);
}

TEST(Dithering, KeepsTheMeanOfEveryDimension) {
  // Over seeds, a pixel's numbers are uniform because the scramble that all pixels share is.
  constexpr uint32_t kSeeds = 20000;
  const double three_errors = 3 / std::sqrt(12.0 * kSeeds);
  for (const uint32_t dimension : {0u, 1u, 2u, 9u}) {
    double sum_x = 0;
    double sum_y = 0;
    double sum_1d = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
      Sampler sampler = Sampler::dithered(blue_noise_tile(), seed, 5, 17, 0);
      sampler.start_dimension(dimension);
      sum_1d += sampler.next_1d();
      const Vec2 u = sampler.next_2d();
      EXPECT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
      sum_x += u.x;
      sum_y += u.y;
    }
    for (const double sum : {sum_x, sum_y, sum_1d}) EXPECT_NEAR(sum / kSeeds, 0.5, three_errors) << dimension;
  }
}

TEST(Dithering, SamplesOfAPixelStayStratified) {
  // Tests a (0, 2)-sequence shifted modulo 1: 64 points leave few of 64 cells empty, independent points 23.
  std::vector<int> cells(64);
  for (uint32_t i = 0; i < 64; ++i) {
    Sampler sampler = Sampler::dithered(blue_noise_tile(), 3, 9, 2, i);
    const Vec2 u = sampler.next_2d();
    ++cells[static_cast<size_t>(u.x * 8) * 8 + static_cast<size_t>(u.y * 8)];
  }
  EXPECT_LT(std::count(cells.begin(), cells.end(), 0), 16);
}

TEST(Dithering, FirstPairIsThatOfTheCamera) {
  const SampleIndex index{.seed = 4, .tile = blue_noise_tile()};
  Sampler sampler = index.sampler(7, 8);
  const Vec2 first = sampler.first_2d();
  EXPECT_EQ(first, sampler.next_2d());
}

TEST(SampleIndex, TheCameraHasOneSequenceThroughAllEpochs) {
  const SampleIndex epoch{.seed = 4, .sequence = 12, .sample = 3, .frame = 15, .age = 10, .camera_runs = true};
  const SampleIndex plain{.seed = 4, .sample = 10, .frame = 15, .age = 10};
  Sampler a = epoch.sampler(7, 8);
  Sampler b = plain.sampler(7, 8);
  EXPECT_EQ(a.first_2d(), b.first_2d());
  for (uint32_t i = 0; i < kCameraDimensions; ++i) EXPECT_EQ(a.next_2d(), b.next_2d());
  EXPECT_NE(a.next_2d(), b.next_2d());
}

TEST(SampleIndex, PixelsTakeTheElementsThatTheyCounted) {
  const std::vector<uint32_t> taken{4, 9};
  const SampleIndex index{.seed = 4, .sample = 20, .age = 20, .taken = view_of(taken), .width = 2};
  for (uint32_t x = 0; x < 2; ++x) {
    Sampler a = index.sampler(x, 0);
    Sampler b = Sampler::sequence(4, x, 0, taken[x]);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(a.next_2d(), b.next_2d());
  }
}

}  // namespace
}  // namespace relume
