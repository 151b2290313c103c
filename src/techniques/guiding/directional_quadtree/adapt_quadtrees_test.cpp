// The forms of the kernel that adapts quadtrees give the same bits.
#include "techniques/guiding/directional_quadtree/adapt_quadtrees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "frame/launch.h"
#include "techniques/guiding/directional_quadtree/testing/random_tree.h"
#include "testing/group_emulation.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::random_tree;

/// Samples by region, some without a finite value.
struct Samples {
  Samples(std::vector<uint32_t> counts_by_region, uint32_t seed) : counts(std::move(counts_by_region)) {
    testing::Random random(seed);
    uint32_t total = 0;
    for (uint32_t region = 0; region < counts.size(); ++region) {
      offsets.push_back(total);
      total += counts[region];
      const Vec2 bright = random.next_2d();
      for (uint32_t i = 0; i < counts[region]; ++i) {
        const bool near = random.next() < 0.3f;
        const Vec2 place = near ? 0.97f * bright + 0.03f * random.next_2d() : random.next_2d();
        float value = (near ? 100.0f : 0.1f) * random.next();
        if (i % 37 == 5) value = i % 2 == 0 ? kInfinity : 0.0f;
        const uint32_t densities = pack_densities(0.05f + random.next(), 0.05f + random.next());
        records.push_back({region, kNoLight, pack_square(place), value, densities});
        importance.push_back({pack_square(place), value});
      }
    }
    offsets.push_back(total);
    order.resize(total);
    std::iota(order.begin(), order.end(), 0u);
  }

  SampleGroupsView view() const {
    return {view_of(records), view_of(order), view_of(offsets), view_of(counts), view_of(importance)};
  }

  std::vector<uint32_t> counts;
  std::vector<uint32_t> offsets;
  std::vector<uint32_t> order;
  std::vector<VertexSample> records;
  std::vector<ImportanceSample> importance;  ///< by record
};

/// Trees with their weights.
struct Trees {
  Trees(uint32_t bits, size_t regions, bool remembers) : bit_count(bits), words(regions * bits / 32) {
    for (uint32_t i = 0; i < regions; ++i) array().store(i, random_tree(bits, i));
    if (remembers) weights.resize(regions, QuadtreeWeights{});
  }

  QuadtreeArray array() { return {mutable_view_of(words), bit_count}; }
  AdaptQuadtreesKernel kernel(const Samples& samples, const QuadtreeAdaption& options, float guided_fraction) {
    return {samples.view(), array(), options, guided_fraction, mutable_view_of(weights), mutable_view_of(moved)};
  }
  bool same_bits(const Trees& other) const {
    return words == other.words && moved == other.moved &&
           (weights.empty() ||
            std::memcmp(weights.data(), other.weights.data(), weights.size() * sizeof(QuadtreeWeights)) == 0);
  }

  uint32_t bit_count;
  std::vector<uint32_t> words;
  std::vector<QuadtreeWeights> weights;
  std::vector<uint64_t> moved = {0};
};

/// Adapts trees in several frames by each form. Returns the number of migrations.
uint64_t compare_forms(uint32_t bit_count, const QuadtreeAdaption& options, float guided_fraction, bool remembers,
                       uint32_t pool = 0, bool importance = false) {
  const std::vector<uint32_t> counts = {0, 1, 5, 127, 128, 129, 700, 0, 9, 0, 0, 0, 0, 0, 0, 3};
  const auto regions = static_cast<uint32_t>(counts.size());
  std::vector<uint32_t> neighbours(6 * regions, kNoRegion);
  for (uint32_t region = 0; region < regions; ++region) neighbours[6 * region + 2] = (region + 5) % regions;
  const auto kernel_of = [&](Trees& t, const Samples& samples) {
    AdaptQuadtreesKernel kernel = t.kernel(samples, options, guided_fraction);
    kernel.pool = {view_of(neighbours), pool, 0.5f};
    kernel.importance = importance;
    return kernel;
  };
  std::vector<Trees> trees(3, Trees(bit_count, regions, remembers));
  for (uint32_t frame = 0; frame < 8; ++frame) {
    const Samples samples(counts, frame % 3);
    for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
      Backend backend(1, form);
      launch(backend, "adapt", kernel_of(trees[form == KernelForm::host ? 0 : 1], samples), regions, 1);
    }
    testing::run_shuffled(kernel_of(trees[2], samples), regions, 1, frame);
    EXPECT_TRUE(trees[0].same_bits(trees[1])) << bit_count << " frame " << frame;
    EXPECT_TRUE(trees[0].same_bits(trees[2])) << bit_count << " frame " << frame;
  }
  return trees[0].moved[0];
}

TEST(AdaptQuadtreesForms, AgreeForAllSizesAndSettings) {
  for (const uint32_t bit_count : {32u, 64u, 96u, 128u}) {
    EXPECT_GT(compare_forms(bit_count, {}, 0, false), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 5}, 0.5f, false), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 4, .kept = 8.0f / 9}, 0.5f, true), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 4, .kept = 8.0f / 9, .spread = 1}, 0, true), 8u);
    EXPECT_GT(compare_forms(bit_count, {.stability = 1, .migrations = 9, .kept = 1, .spread = 0.3f}, 0.9f, true), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 3, .spread = 1}, 0, false), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 3}, 0, false, 600), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 3, .kept = 8.0f / 9}, 0.5f, true, 600), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 3, .spread = 1}, 0, false, 0, true), 8u);
    EXPECT_GT(compare_forms(bit_count, {.migrations = 3, .kept = 8.0f / 9}, 0, true, 600, true), 8u);
  }
}

/// Region 0 has all the light, in one direction. Region 3 is a sibling, region 9 a neighbour; region 1 has its own
/// samples.
class Pool : public ::testing::Test {
 protected:
  static constexpr uint32_t kRegions = 16;

  Pool() : neighbours_(6 * kRegions, kNoRegion), counts_(kRegions, 0), words_(4 * kRegions) {
    neighbours_[6 * 9 + 2] = 0;
    const auto record = [&](uint32_t region, const Vec2& place, uint32_t times) {
      for (uint32_t i = 0; i < times; ++i)
        records_.push_back({region, kNoLight, pack_square(place), 1.0f, pack_densities(0.08f, 0.08f)});
      counts_[region] = times;
    };
    record(0, bright_, 300);
    record(1, Vec2(0.8f, 0.7f), 500);
    for (uint32_t region = 0; region <= kRegions; ++region)
      offsets_.push_back(region == 0 ? 0 : region == 1 ? 300 : 800);
    order_.resize(records_.size());
    std::iota(order_.begin(), order_.end(), 0u);
  }

  SampleGroupsView samples() const { return {view_of(records_), view_of(order_), view_of(offsets_), view_of(counts_)}; }
  /// Density in the bright direction over that of a uniform tree, after ten frames.
  std::vector<float> learned(uint32_t pool) {
    const QuadtreeArray trees{mutable_view_of(words_), 128};
    for (uint32_t region = 0; region < kRegions; ++region) trees.store(region, uniform_quadtree(128));
    std::vector<uint64_t> moved{0};
    AdaptQuadtreesKernel kernel{samples(), trees, {}, 0, {}, mutable_view_of(moved)};
    kernel.pool = {view_of(neighbours_), pool, 0.5f};
    Backend backend(2);
    for (int frame = 0; frame < 10; ++frame) launch(backend, "adapt", kernel, kRegions, 1);
    const Vec3 w = direction_from_square(bright_);
    std::vector<float> ratios;
    for (uint32_t region = 0; region < kRegions; ++region)
      ratios.push_back(trees.load(region).pdf(w) / uniform_quadtree(128).pdf(w));
    return ratios;
  }

  Vec2 bright_{0.3f, 0.2f};
  std::vector<uint32_t> neighbours_;
  std::vector<uint32_t> counts_;
  std::vector<uint32_t> words_;
  std::vector<VertexSample> records_;
  std::vector<uint32_t> offsets_;
  std::vector<uint32_t> order_;
};

TEST_F(Pool, LearnsFromNeighboursAndSiblings) {
  const std::vector<float> own = learned(0);
  EXPECT_GT(own[0], 8.0f);
  for (const uint32_t region : {3u, 9u, 10u}) EXPECT_EQ(own[region], 1.0f);
  const std::vector<float> pooled = learned(400);
  EXPECT_GT(pooled[0], 8.0f);
  EXPECT_GT(pooled[3], 8.0f);
  EXPECT_GT(pooled[9], 8.0f);
  EXPECT_EQ(pooled[10], 1.0f);  // neither
  EXPECT_LE(pooled[1], 1.0f);   // has enough samples
}

TEST_F(Pool, CountsEachRegionOnceAndByNeed) {
  neighbours_[6 * 3] = 0;  // a sibling, too
  const QuadtreePool pool{view_of(neighbours_), 400, 0.5f};
  EXPECT_EQ(PooledSamples(samples(), pool, 3).size(), 800u);
  EXPECT_EQ(PooledSamples(samples(), pool, 3).factor, 1.0f);
  EXPECT_EQ(PooledSamples(samples(), pool, 0).size(), 800u);
  EXPECT_FLOAT_EQ(PooledSamples(samples(), pool, 0).factor, 0.5f);  // squares count a quarter
  EXPECT_EQ(PooledSamples(samples(), pool, 1).size(), 500u);
  EXPECT_EQ(PooledSamples(samples(), pool, 10).size(), 0u);
}

/// The sums of squares, from which trees migrate.
TEST(AdaptQuadtreesWeights, RecordsCountByTheirWeight) {
  constexpr QuadtreeAdaption kNoMigrations{.migrations = 0, .kept = 1};
  Samples once({40, 0}, 2);
  for (VertexSample& s : once.records) s.weight = 4;
  Samples four_times({160, 0}, 2);
  for (uint32_t i = 0; i < 160; ++i) four_times.records[i] = Samples({40, 0}, 2).records[i / 4];
  std::vector<Trees> trees(2, Trees(64, 2, true));
  Backend backend(1);
  launch(backend, "adapt", trees[0].kernel(once, kNoMigrations, 0), 2, 1);
  launch(backend, "adapt", trees[1].kernel(four_times, kNoMigrations, 0), 2, 1);
  float largest = 0;
  for (uint32_t bit = 0; bit < QuadtreeWeights::kBits; ++bit) {
    const float expected = trees[1].weights[0].found[bit];
    EXPECT_NEAR(trees[0].weights[0].found[bit], expected, 1e-4f * expected) << bit;
    largest = std::max(largest, expected);
  }
  EXPECT_GT(largest, 1.0f);
}

/// Sums of squares would count a sample of twice the importance four times.
TEST(AdaptQuadtreesImportance, SumsAreTheImportanceOfWeightedRecords) {
  constexpr QuadtreeAdaption kNoMigrations{.migrations = 0, .kept = 1};
  Samples samples({40, 30}, 2);
  Trees trees(64, 2, true);
  std::vector<std::vector<float>> expected(2, std::vector<float>(QuadtreeWeights::kBits));
  testing::Random random(7);
  for (size_t i = 0; i < samples.records.size(); ++i) {
    VertexSample& record = samples.records[i];
    record.weight = 0.5f + random.next();
    ImportanceSample& s = samples.importance[i];
    s = {pack_square(random.next_2d()), i % 5 == 0 ? 0.0f : 0.1f + random.next()};
    const uint32_t bit = trees.array().load(record.region).find(unpack_square(s.direction)).bit;
    expected[record.region][bit] += s.value * record.weight;
  }
  AdaptQuadtreesKernel kernel = trees.kernel(samples, kNoMigrations, 0);
  kernel.importance = true;
  Backend backend(1);
  launch(backend, "adapt", kernel, 2, 1);
  for (uint32_t region = 0; region < 2; ++region) {
    for (uint32_t bit = 0; bit < QuadtreeWeights::kBits; ++bit) {
      const float sum = expected[region][bit];
      EXPECT_NEAR(trees.weights[region].found[bit], sum, 1e-5f * sum) << bit;
    }
  }
}

/// Nine tenths of the importance arrive from a 64th of the directions.
TEST(AdaptQuadtreesImportance, DensityRisesWhereImportanceArrives) {
  Samples samples({900}, 2);
  testing::Random random(8);
  for (size_t i = 0; i < samples.records.size(); ++i) {
    const Vec2 place = random.next_2d();
    const bool bright = i % 2 == 0;
    samples.records[i].value = 0;  // no radiance
    samples.importance[i] = {pack_square(bright ? 0.625f + 0.125f * place : place), bright ? 0.9f : 0.1f};
  }
  Trees trees(128, 1, false);
  trees.array().store(0, uniform_quadtree(128));
  AdaptQuadtreesKernel kernel = trees.kernel(samples, {.stability = importance_stability(0.1f)}, 0);
  kernel.importance = true;
  Backend backend(1);
  for (int frame = 0; frame < 60; ++frame) launch(backend, "adapt", kernel, 1, 1);
  const DirectionalQuadtree tree = trees.array().load(0);
  float ratio = 0;
  constexpr int kPlaces = 100;
  for (int i = 0; i < kPlaces; ++i) {
    const Vec3 w = direction_from_square(0.625f + 0.125f * random.next_2d());
    ratio += tree.pdf(w) / uniform_quadtree(128).pdf(w) / kPlaces;
  }
  EXPECT_GT(ratio, 8.0f);
  EXPECT_GT(trees.moved[0], 8u);
}

TEST(AdaptQuadtreesImportance, StabilityIsThatOfSquares) {
  EXPECT_FLOAT_EQ(importance_stability(0.04f), 0.4f);
  EXPECT_FLOAT_EQ(importance_stability(1.0f), 1.0f);
}

TEST(AdaptQuadtreesForms, AgreeOnThreads) {
  const Samples samples({3, 200, 129}, 4);
  for (const QuadtreeAdaption& options : {QuadtreeAdaption{}, QuadtreeAdaption{0.5f, 4, 0.9f, 1}}) {
    std::vector<Trees> trees(2, Trees(128, 3, true));
    Backend backend(1);
    launch(backend, "adapt", trees[0].kernel(samples, options, 0.5f), 3, 1);
    testing::run_threaded(trees[1].kernel(samples, options, 0.5f), 3, 1);
    EXPECT_TRUE(trees[0].same_bits(trees[1]));
    EXPECT_GT(trees[0].moved[0], 0u);
  }
}

}  // namespace
}  // namespace relume
