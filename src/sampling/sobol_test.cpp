#include "sampling/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "sampling/sampler.h"
#include "testing/chi2.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::Random;

/// Second Sobol' dimension from its definition: primitive polynomial x + 1, m_1 = 1, m_k = 2 m_{k−1} ⊕ m_{k−1}. The
/// direction numbers are v_k = m_k / 2^k. The point is the exclusive or of those that the bits of the index select.
uint32_t sobol_by_direction_numbers(uint32_t index) {
  uint32_t result = 0;
  uint32_t m = 1;
  for (int k = 1; k <= 32; ++k) {
    if ((index >> (k - 1)) & 1u) result ^= m << (32 - k);
    m = (m << 1) ^ m;
  }
  return result;
}

TEST(Sobol, SecondDimensionFollowsItsDirectionNumbers) {
  for (uint32_t i = 0; i < 10000; ++i) {
    ASSERT_EQ(reverse_bits(sobol_dimension_1_reversed(i)), sobol_by_direction_numbers(i)) << i;
    const uint32_t large = hash(i);
    ASSERT_EQ(reverse_bits(sobol_dimension_1_reversed(large)), sobol_by_direction_numbers(large)) << large;
  }
}

TEST(Sobol, ReversesBits) {
  EXPECT_EQ(reverse_bits(1u), 0x80000000u);
  EXPECT_EQ(reverse_bits(0x12345678u), 0x1e6a2c48u);
}

TEST(Sobol, ScrambleIsNested) {
  // Bit i of the result depends on bits 0 … i only: flipping bit i keeps the lower bits and flips bit i.
  for (uint32_t n = 0; n < 2000; ++n) {
    const uint32_t x = hash(n, 1u);
    const uint32_t seed = hash(n, 2u);
    const uint32_t bit = n % 32;
    const uint32_t difference = owen_scramble_reversed(x, seed) ^ owen_scramble_reversed(x ^ (1u << bit), seed);
    ASSERT_EQ(difference & ((1u << bit) - 1u), 0u);
    ASSERT_NE(difference & (1u << bit), 0u);
  }
}

/// Whether each elementary interval of area 2^-k contains exactly one of the 2^k points of `run`.
bool stratified(const std::vector<Vec2>& run, int k) {
  for (int j = 0; j <= k; ++j) {
    std::vector<bool> taken(run.size(), false);
    for (const Vec2& p : run) {
      const auto column = static_cast<uint32_t>(std::ldexp(p.x, j));
      const auto row = static_cast<uint32_t>(std::ldexp(p.y, k - j));
      const size_t cell = (size_t{row} << j) + column;
      if (taken[cell]) return false;
      taken[cell] = true;
    }
  }
  return true;
}

Vec2 point(uint32_t index, uint32_t seed) { return owen_sobol_2d(reverse_bits(index), seed); }
float single(uint32_t index, uint32_t seed) { return owen_van_der_corput(reverse_bits(index), seed); }

TEST(Sobol, IsAZeroTwoSequence) {
  for (const uint32_t seed : {0u, 1u, 0xdeadbeefu, 0xffffffffu}) {
    for (int k = 0; k <= 12; ++k) {
      for (const uint32_t start : {0u, 1u, 5u}) {
        std::vector<Vec2> run;
        for (uint32_t i = 0; i < (1u << k); ++i) run.push_back(point((start << k) + i, seed));
        ASSERT_TRUE(stratified(run, k)) << "seed " << seed << ", run " << start << " of 2^" << k;
      }
    }
  }
}

TEST(Sobol, VanDerCorputStratifiesEveryAlignedRun) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    for (int k = 0; k <= 12; ++k) {
      std::set<uint32_t> cells;
      for (uint32_t i = 0; i < (1u << k); ++i) {
        cells.insert(static_cast<uint32_t>(std::ldexp(single((3u << k) + i, seed), k)));
      }
      ASSERT_EQ(cells.size(), size_t{1} << k);
    }
  }
}

TEST(Sobol, IntegratesBetterThanRandomNumbers) {
  // Sums the squared error of the mean of a smooth function over the seeds, 256 points each. Random points would give
  // var/256.
  double error = 0;
  constexpr int kSeeds = 100;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    double mean = 0;
    for (uint32_t i = 0; i < 256; ++i) {
      const Vec2 p = point(i, hash(seed));
      mean += std::exp(p.x) * p.y / 256.0;
    }
    error += std::pow(mean - 0.5 * (std::exp(1.0) - 1.0), 2) / kSeeds;
  }
  const double variance = (std::exp(2.0) - 1.0) / 6.0 - 0.25 * std::pow(std::exp(1.0) - 1.0, 2);
  EXPECT_LT(error, 0.02 * variance / 256.0);  // n^-3 against n^-1 leaves ample margin
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - 0.5) * (b[i] - 0.5);
  return 12.0 * sum / static_cast<double>(a.size());
}

/// First numbers of each dimension of a pixel.
std::vector<std::vector<float>> dimensions(uint32_t seed, uint32_t x, uint32_t y, int count, uint32_t samples) {
  std::vector<std::vector<float>> result(static_cast<size_t>(count) * 2);
  for (uint32_t s = 0; s < samples; ++s) {
    Sampler sampler = Sampler::sequence(seed, x, y, s);
    for (size_t d = 0; d < static_cast<size_t>(count); ++d) {
      const Vec2 p = sampler.next_2d();
      result[2 * d].push_back(p.x);
      result[2 * d + 1].push_back(p.y);
    }
  }
  return result;
}

TEST(Sampler, DimensionsPixelsAndSeedsAreUncorrelated) {
  // Shuffled independently, the correlation of n stratified numbers has a standard deviation of about 1/√n. A limit of
  // 5.5 of them gives a false alarm in 10^-7 of the cases; some 3,000 pairs are compared.
  constexpr uint32_t kSamples = 1024;
  const double bound = 5.5 / std::sqrt(double{kSamples});
  std::vector<std::vector<float>> all;
  for (const UVec3 key : {UVec3(0, 0, 0), UVec3(0, 1, 0), UVec3(0, 0, 1), UVec3(1, 0, 0), UVec3(7, 511, 300)}) {
    for (auto& d : dimensions(key.x, key.y, key.z, 8, kSamples)) all.push_back(std::move(d));
  }
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t j = 0; j < i; ++j) ASSERT_LT(std::fabs(correlation(all[i], all[j])), bound) << i << ' ' << j;
  }
}

TEST(Sampler, IsAFunctionOfItsArguments) {
  const auto numbers = [](Sampler s) {
    std::vector<float> v;
    for (int i = 0; i < 4; ++i) {
      v.push_back(s.next_1d());
      const Vec2 p = s.next_2d();
      v.push_back(p.x);
      v.push_back(p.y);
    }
    return v;
  };
  const auto reference = numbers(Sampler::sequence(1, 2, 3, 4));
  EXPECT_EQ(reference, numbers(Sampler::sequence(1, 2, 3, 4)));
  for (const Sampler& other :
       {Sampler::sequence(2, 2, 3, 4), Sampler::sequence(1, 3, 3, 4), Sampler::sequence(1, 2, 4, 4),
        Sampler::sequence(1, 2, 3, 5), Sampler::sequence(1, 2, 3, 4, 0)}) {
    EXPECT_NE(reference, numbers(other));
  }
  EXPECT_NE(numbers(Sampler::sequence(1, 2, 3, 4, 0)), numbers(Sampler::sequence(1, 2, 3, 4, 1)));
  EXPECT_EQ(numbers(Sampler::sequence(1, 2, 3, 4, 5)), numbers(Sampler::sequence(1, 2, 3, 4, 5)));
}

TEST(Sampler, JumpsToADimension) {
  Sampler a = Sampler::sequence(1, 2, 3, 4);
  Sampler b = a;
  for (int i = 0; i < 5; ++i) a.next_2d();
  a.next_1d();
  b.next_1d();
  b.next_1d();
  for (Sampler* s : {&a, &b}) s->start_dimension(20);
  EXPECT_EQ(a.next_1d(), b.next_1d());
  EXPECT_EQ(a.next_2d(), b.next_2d());
  EXPECT_EQ(a.ray_id(), b.ray_id());
}

TEST(Sampler, FirstPairIsTheFirstPair) {
  Sampler s = Sampler::sequence(1, 2, 3, 4);
  const Vec2 first = s.first_2d();
  EXPECT_EQ(first, s.next_2d());
}

TEST(Sampler, RayIdsDifferBetweenSamplesAndRays) {
  std::set<uint32_t> ids;
  for (uint32_t s = 0; s < 1000; ++s) {
    Sampler sampler = Sampler::sequence(0, 1, 2, s);
    ids.insert(sampler.ray_id());
    sampler.next_2d();
    ids.insert(sampler.ray_id());
  }
  EXPECT_GE(ids.size(), 1999u);  // 2,000 hashes of 32 bits collide with probability 5e-4
}

/// χ² of the numbers of `next` over pixels: they are independent across pixels.
template <typename Next>
double uniformity(const Next& next) {
  testing::Histogram histogram(16);
  for (uint32_t y = 0; y < 200; ++y) {
    for (uint32_t x = 0; x < 200; ++x) {
      const Vec2 p = next(x, y);
      EXPECT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f);
      histogram.add(p.x, p.y);
    }
  }
  return histogram.test([](double, double) { return 1.0; }).p_value;
}

TEST(Sampler, NumbersAreUniformOverPixels) {
  for (const uint32_t sample : {0u, 1u, 77u}) {
    const auto pair = [&](uint32_t x, uint32_t y) { return Sampler::sequence(0, x, y, sample).next_2d(); };
    EXPECT_GT(uniformity(pair), testing::significance());
    const auto singles = [&](uint32_t x, uint32_t y) {
      Sampler s = Sampler::sequence(0, x, y, sample);
      const float first = s.next_1d();
      return Vec2(first, s.next_1d());
    };
    EXPECT_GT(uniformity(singles), testing::significance());
    const auto frames = [&](uint32_t x, uint32_t y) { return Sampler::sequence(3, x, 0, sample, y).next_2d(); };
    EXPECT_GT(uniformity(frames), testing::significance());
  }
}

TEST(Sampler, SequenceStratifiesWithinAPixel) {
  std::vector<Vec2> run;
  for (uint32_t s = 0; s < 256; ++s) run.push_back(Sampler::sequence(9, 4, 5, s).next_2d());
  EXPECT_TRUE(stratified(run, 8));
}

}  // namespace
}  // namespace relume
