// Discrete and piecewise-constant densities, and MIS weights.
#include <gtest/gtest.h>

#include <vector>

#include "sampling/alias_table.h"
#include "sampling/choose.h"
#include "sampling/distribution_2d.h"
#include "sampling/mis.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::Random;

std::vector<std::vector<float>> weight_lists() {
  std::vector<std::vector<float>> lists{
      {1}, {1, 1}, {0, 1}, {1, 0, 3, 0}, {1e-20f, 1, 1e20f}, {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5}};
  std::vector<float> many;
  for (uint32_t i = 0; i < 1000; ++i) many.push_back(i % 7 == 0 ? 0.0f : std::pow(to_unit_float(hash(i)), 4.0f));
  lists.push_back(many);
  return lists;
}

TEST(AliasTable, ProbabilitiesSumToOneAndFollowTheWeights) {
  for (const auto& weights : weight_lists()) {
    const auto entries = build_alias_table(weights);
    ASSERT_EQ(entries.size(), weights.size());
    double sum = 0;
    double total = 0;
    for (const float w : weights) total += w;
    // Compares the probabilities that keep and alias imply with the stated ones.
    std::vector<double> implied(weights.size(), 0.0);
    for (size_t i = 0; i < entries.size(); ++i) {
      sum += entries[i].pmf;
      EXPECT_FLOAT_EQ(entries[i].pmf, static_cast<float>(weights[i] / total));
      implied[i] += entries[i].keep / static_cast<double>(weights.size());
      implied[entries[i].alias] += (1.0 - entries[i].keep) / static_cast<double>(weights.size());
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);  // allows for a thousand float roundings
    for (size_t i = 0; i < entries.size(); ++i) EXPECT_NEAR(implied[i], entries[i].pmf, 1e-6);
  }
}

TEST(AliasTable, FrequenciesFollowAndTheRestIsUniform) {
  for (const auto& weights : weight_lists()) {
    const auto entries = build_alias_table(weights);
    const AliasTable table{view_of(entries)};
    constexpr int kSamples = 200000;
    std::vector<uint64_t> counts(weights.size(), 0);
    std::vector<uint64_t> rest(64, 0);
    Random random(21);
    for (int i = 0; i < kSamples; ++i) {
      const DiscreteSample s = table.sample({random.next(), random.next_bits()});
      ASSERT_LT(s.index, weights.size());
      ASSERT_GT(s.pmf, 0.0f);
      ASSERT_EQ(s.pmf, table.pmf(s.index));
      ASSERT_TRUE(s.u >= 0.0f && s.u < 1.0f);
      ++counts[s.index];
      ++rest[static_cast<size_t>(s.u * 64)];
    }
    std::vector<double> expected;
    for (const AliasEntry& e : entries) expected.push_back(e.pmf * double{kSamples});
    EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
    EXPECT_GT(testing::chi2_test(rest, std::vector<double>(64, kSamples / 64.0)).p_value, testing::significance());
  }
}

TEST(AliasTable, IsEmptyWithoutWeight) {
  EXPECT_TRUE(build_alias_table(std::vector<float>{}).empty());
  EXPECT_TRUE(build_alias_table(std::vector<float>{0, 0}).empty());
  EXPECT_TRUE(build_alias_table(std::vector<float>{1, kInfinity}).empty());
}

TEST(AliasTable, SurvivesTheEdgesOfTheUnitInterval) {
  for (const auto& weights : weight_lists()) {
    const auto entries = build_alias_table(weights);
    for (const float u : {0.0f, kOneMinusEpsilon}) {
      const DiscreteSample s = AliasTable{view_of(entries)}.sample({u, 1});
      EXPECT_GT(weights[s.index], 0.0f);
      EXPECT_TRUE(s.u >= 0.0f && s.u < 1.0f);
    }
  }
}

TEST(AliasTable, ReachesEachOfAMillionEntriesInProportion) {
  // Every other light is dim: a 24-bit number would choose it 16 times too often, or never.
  constexpr size_t kCount = size_t{1} << 20;
  std::vector<float> weights(kCount);
  for (size_t i = 0; i < kCount; ++i) weights[i] = i % 2 == 0 ? 1.0f : 1e-3f * static_cast<float>(1 + i % 8);
  const auto entries = build_alias_table(weights);
  constexpr int kSamples = 4000000;
  std::vector<uint64_t> counts(8, 0);
  std::vector<uint64_t> rest(64, 0);
  std::vector<double> expected(8, 0);
  for (size_t i = 0; i < kCount; ++i) expected[i % 8] += entries[i].pmf * double{kSamples};
  Random random(31);
  for (int i = 0; i < kSamples; ++i) {
    const DiscreteSample s = AliasTable{view_of(entries)}.sample({random.next(), random.next_bits()});
    ++counts[s.index % 8];
    ++rest[static_cast<size_t>(s.u * 64)];
  }
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
  EXPECT_GT(testing::chi2_test(rest, std::vector<double>(64, kSamples / 64.0)).p_value, testing::significance());
}

struct Grid {
  uint32_t width;
  uint32_t height;
  std::vector<float> values;
};

std::vector<Grid> grids() {
  std::vector<Grid> list{{1, 1, {2}}, {3, 2, {0, 1, 0, 5, 0, 2}}, {2, 3, {1, 2, 0, 0, 3, 4}}};
  Grid many{40, 20, {}};
  for (uint32_t i = 0; i < 800; ++i) many.values.push_back(i % 5 == 0 ? 0.0f : sqr(to_unit_float(hash(i, 3u))));
  many.values[333] = 100;  // as bright as a sun
  list.push_back(many);
  return list;
}

TEST(Distribution2D, DensityIsProportionalToTheValues) {
  for (const Grid& g : grids()) {
    const auto storage = build_distribution_2d(g.values, g.width, g.height);
    double total = 0;
    for (const float v : g.values) total += v;
    double integral = 0;
    for (uint32_t j = 0; j < g.height; ++j) {
      for (uint32_t i = 0; i < g.width; ++i) {
        const float pdf = storage.view().pdf({(static_cast<float>(i) + 0.5f) / static_cast<float>(g.width),
                                              (static_cast<float>(j) + 0.5f) / static_cast<float>(g.height)});
        const double cells = g.width * g.height;
        integral += pdf / cells;
        // Float CDFs resolve a cell's share of its row, and the row's share, to 6e-8 each.
        EXPECT_NEAR(pdf, g.values[j * g.width + i] / total * cells, 2e-7 * cells);
      }
    }
    EXPECT_NEAR(integral, 1.0, 1e-5);
  }
}

TEST(Distribution2D, SamplesFollowTheDensity) {
  for (const Grid& g : grids()) {
    const auto storage = build_distribution_2d(g.values, g.width, g.height);
    const Distribution2D d = storage.view();
    std::vector<uint64_t> counts(g.values.size() * 4, 0);  // quarters of each cell
    std::vector<double> expected(counts.size());
    constexpr int kSamples = 200000;
    Random random(22);
    for (int i = 0; i < kSamples; ++i) {
      const Distribution2D::Sample s = d.sample(random.next_2d());
      ASSERT_TRUE(s.point.x >= 0 && s.point.x <= 1 && s.point.y >= 0 && s.point.y <= 1);
      ASSERT_GT(s.pdf, 0.0f);
      ++counts[std::min(static_cast<uint32_t>(s.point.y * 2 * static_cast<float>(g.height)), 2 * g.height - 1) * 2 *
                   g.width +
               std::min(static_cast<uint32_t>(s.point.x * 2 * static_cast<float>(g.width)), 2 * g.width - 1)];
    }
    for (size_t k = 0; k < counts.size(); ++k) {
      const Vec2 p((static_cast<float>(k % (2 * g.width)) + 0.5f) / (2 * static_cast<float>(g.width)),
                   (static_cast<float>(k / (2 * g.width)) + 0.5f) / (2 * static_cast<float>(g.height)));
      expected[k] = kSamples * double{d.pdf(p)} / static_cast<double>(counts.size());
    }
    EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
  }
}

TEST(Distribution2D, InverseInverts) {
  for (const Grid& g : grids()) {
    const auto storage = build_distribution_2d(g.values, g.width, g.height);
    Random random(23);
    for (int i = 0; i < 10000; ++i) {
      const Vec2 u = random.next_2d();
      const Distribution2D::Sample s = storage.view().sample(u);
      const Vec2 back = storage.view().inverse(s.point);
      // A point in [0, 1) has a resolution of 6e-8, which a density d multiplies by d.
      EXPECT_NEAR(back.x, u.x, 1e-5f + 3e-7f * s.pdf);
      EXPECT_NEAR(back.y, u.y, 1e-5f + 3e-7f * s.pdf);
    }
  }
}

TEST(Distribution2D, IsEmptyWithoutWeight) {
  EXPECT_EQ(build_distribution_2d(std::vector<float>{0, 0}, 2, 1).width, 0u);
  EXPECT_EQ(build_distribution_2d(std::vector<float>{1, kInfinity}, 2, 1).width, 0u);
  EXPECT_TRUE(Distribution2D{}.empty());
}

TEST(TakesShare, LeavesAUniformRest) {
  for (const float share : {0.0f, 0.25f, 1.0f}) {
    int taken = 0;
    for (int i = 0; i < 1000; ++i) {
      const float before = (static_cast<float>(i) + 0.5f) / 1000;
      float u = before;
      const bool first = takes_share(share, u);
      taken += first ? 1 : 0;
      EXPECT_NEAR(first ? u * share : share + u * (1 - share), before, 1e-6f);
      EXPECT_GE(u, 0.0f);
      EXPECT_LT(u, 1.0f);
    }
    EXPECT_EQ(taken, static_cast<int>(1000 * share));
  }
}

TEST(ChooseEvenly, LeavesAUniformRest) {
  for (const uint32_t count : {1u, 3u, 64u, 1000u}) {
    std::vector<int> chosen(count, 0);
    for (int i = 0; i < 64000; ++i) {
      const float before = (static_cast<float>(i) + 0.5f) / 64000;
      float u = before;
      const uint32_t k = choose_evenly(count, u);
      ASSERT_LT(k, count);
      ++chosen[k];
      EXPECT_NEAR((static_cast<float>(k) + u) / static_cast<float>(count), before, 1e-6f);
      EXPECT_GE(u, 0.0f);
      EXPECT_LT(u, 1.0f);
    }
    for (const int times : chosen) EXPECT_NEAR(times, 64000 / static_cast<double>(count), 1) << count;
  }
  for (const uint32_t count : {1u, 3u, 64u, 1000u, 1u << 24, 0xffffffffu}) {
    float last = kOneMinusEpsilon;
    EXPECT_LT(choose_evenly(count, last), count);
    EXPECT_GE(last, 0.0f);
    EXPECT_LT(last, 1.0f);
  }
}

TEST(ReusableNumber, SupportsAnyNumberOfDecisions) {
  // Twelve choices among eight take 36 bits; the remainder is still uniform, and as independent as new numbers.
  constexpr int kSamples = 100000;
  const float weights[8] = {1, 2, 0.5f, 0, 3, 1, 0.25f, 0.25f};
  std::vector<std::vector<uint64_t>> counts(12, std::vector<uint64_t>(8, 0));
  std::vector<uint64_t> pairs(64, 0);
  std::vector<uint64_t> rest(64, 0);
  Random random(33);
  for (int i = 0; i < kSamples; ++i) {
    ReusableNumber n{random.next(), random.next_bits()};
    uint32_t last = 0;
    for (size_t k = 0; k < counts.size(); ++k) {
      const uint32_t chosen = k % 2 == 0 ? choose_by_weight(weights, 8, 8, n) : choose_evenly(8, n);
      ++counts[k][chosen];
      if (k == 11) ++pairs[8 * last + chosen];
      last = chosen;
    }
    if (takes_share(0.25f, n))
      ++rest[static_cast<size_t>(n.u * 16)];
    else
      ++rest[16 + static_cast<size_t>(n.u * 48)];
  }
  std::vector<double> by_weight;
  std::vector<double> both;
  for (const float w : weights) {
    by_weight.push_back(double{w} / 8 * kSamples);
    for (int k = 0; k < 8; ++k) both.push_back(double{w} / 64 * kSamples);
  }
  const std::vector<double> evenly(8, kSamples / 8.0);
  for (size_t k = 0; k < counts.size(); ++k)
    EXPECT_GT(testing::chi2_test(counts[k], k % 2 == 0 ? by_weight : evenly).p_value, testing::significance()) << k;
  EXPECT_GT(testing::chi2_test(pairs, both).p_value, testing::significance());
  EXPECT_GT(testing::chi2_test(rest, std::vector<double>(64, kSamples / 64.0)).p_value, testing::significance());
}

TEST(ReusableNumber, SelectsRareEntriesAtTheRightRate) {
  // The 24 bits only select the second bin, at half of the interval. The appended bits decide between the bin and its
  // alias.
  const std::vector<float> weights{1, 1e-9f};
  const auto entries = build_alias_table(weights);
  const AliasTable table{view_of(entries)};
  constexpr int kSamples = 1000000;
  int kept = 0;
  Random random(35);
  for (int i = 0; i < kSamples; ++i) kept += table.sample({0.5f, random.next_bits()}).index == 1 ? 1 : 0;
  const double expected = 2e-9 * 0x1p23 * kSamples;  // 2e-9 of a bin, which 2^23 numbers of 24 bits share
  EXPECT_NEAR(kept, expected, 5 * std::sqrt(expected));
}

TEST(ReusableNumber, KeepsStrata) {
  for (uint32_t i = 0; i < 64; ++i) {
    ReusableNumber n{(static_cast<float>(i) + 0.5f) / 64, i};
    EXPECT_EQ(choose_evenly(16, n), i / 4);
    EXPECT_NEAR(n.u, (static_cast<float>(i % 4) + 0.5f) / 4, 1e-5f);
    EXPECT_EQ(takes_share(0.5f, n), i % 4 < 2);
    EXPECT_NEAR(n.u, (static_cast<float>(i % 2) + 0.5f) / 2, 1e-5f);
    EXPECT_TRUE(takes_share(1.0f, n));
    EXPECT_FALSE(takes_share(0.0f, n));
    EXPECT_NEAR(n.u, (static_cast<float>(i % 2) + 0.5f) / 2, 1e-5f);
  }
}

TEST(ReusableNumber, ReachesEveryIndexOf32Bits) {
  constexpr uint32_t kMany = 3000000000u;
  constexpr int kSamples = 64000;
  std::vector<uint64_t> low(64, 0);
  std::vector<uint64_t> high(64, 0);
  Random random(34);
  for (int i = 0; i < kSamples; ++i) {
    ReusableNumber n{random.next(), random.next_bits()};
    const uint32_t chosen = choose_evenly(kMany, n);
    ASSERT_LT(chosen, kMany);
    ++low[chosen % 64];
    ++high[chosen / (kMany / 64)];
  }
  const std::vector<double> expected(64, kSamples / 64.0);
  EXPECT_GT(testing::chi2_test(low, expected).p_value, testing::significance());
  EXPECT_GT(testing::chi2_test(high, expected).p_value, testing::significance());
}

TEST(ReusableNumber, SurvivesTheEdgesOfTheUnitInterval) {
  for (const float u : {0.0f, 0x1p-24f, kOneMinusEpsilon}) {
    for (const float share : {1e-12f, 0.3f, kOneMinusEpsilon}) {
      ReusableNumber n{u, 0xffffffffu};
      takes_share(share, n);
      EXPECT_TRUE(n.u >= 0.0f && n.u < 1.0f) << u << " " << share;
    }
    for (const uint32_t count : {1u, 7u, 0xffffffffu}) {
      ReusableNumber n{u, 0xffffffffu};
      EXPECT_LT(choose_evenly(count, n), count);
      EXPECT_TRUE(n.u >= 0.0f && n.u < 1.0f) << u << " " << count;
    }
  }
}

TEST(Mis, WeightsSumToOne) {
  Random random(24);
  for (int i = 0; i < 10000; ++i) {
    const float a = std::exp2(40.0f * random.next() - 20.0f);
    const float b = std::exp2(40.0f * random.next() - 20.0f);
    ASSERT_NEAR(power_heuristic(a, b) + power_heuristic(b, a), 1.0f, 3e-7f);
  }
  EXPECT_EQ(power_heuristic(1.0f, 0.0f), 1.0f);
  EXPECT_FLOAT_EQ(power_heuristic(2.0f, 1.0f), 0.8f);
  EXPECT_EQ(power_heuristic(1e-20f, 1e20f), 0.0f);  // the squares overflow to infinity, not NaN
}

}  // namespace
}  // namespace relume
