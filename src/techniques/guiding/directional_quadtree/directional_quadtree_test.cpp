#include "techniques/guiding/directional_quadtree/directional_quadtree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "techniques/guiding/directional_quadtree/adapt_quadtree.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"
#include "techniques/guiding/directional_quadtree/testing/random_tree.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::random_tree;

constexpr uint32_t kBitCounts[] = {32, 64, 96, 128};

/// Squares of all leaves, computed without rank and select.
struct Leaf {
  double x, y, edge;
};
std::vector<Leaf> leaves_of(const DirectionalQuadtree& tree) {
  std::vector<Leaf> level{{0, 0, 1}};  // inner nodes of this level
  std::vector<Leaf> leaves;
  uint32_t bit = 0;
  while (!level.empty()) {
    std::vector<Leaf> next;
    for (const Leaf& node : level) {
      for (int i = 0; i < 4; ++i) {
        const Leaf child{node.x + (i & 1) * node.edge / 2, node.y + (i >> 1) * node.edge / 2, node.edge / 2};
        (tree.bits.get(bit++) ? next : leaves).push_back(child);
      }
    }
    level = next;
  }
  EXPECT_EQ(bit, tree.bit_count);  // all bits are used
  return leaves;
}

TEST(BitField, RankAndSelectAgreeWithCounting) {
  testing::Random random(3);
  for (int round = 0; round < 50; ++round) {
    BitField field{};
    const float density = random.next();
    for (uint32_t i = 0; i < 128; ++i) {
      if (random.next() < density) field.set(i);
    }
    uint32_t ones = 0;
    for (uint32_t i = 0; i < 128; ++i) {
      ASSERT_EQ(field.rank(i), ones);
      if (field.get(i)) {
        ASSERT_EQ(field.select(ones, true), i);
        ++ones;
      } else {
        ASSERT_EQ(field.select(i - ones, false), i);
      }
    }
    ASSERT_EQ(field.rank(128), ones);
  }
}

TEST(BitField, NibblesAreRemovedAndInserted) {
  testing::Random random(4);
  for (uint32_t group = 0; group < 32; ++group) {
    BitField field{};
    std::vector<bool> bits;
    for (uint32_t i = 0; i < 128; ++i) {
      bits.push_back(random.next() < 0.5f);
      if (bits.back()) field.set(i);
    }
    field.remove_nibble(group);
    bits.erase(bits.begin() + 4 * group, bits.begin() + 4 * group + 4);
    bits.insert(bits.end(), 4, false);
    for (uint32_t i = 0; i < 128; ++i) ASSERT_EQ(field.get(i), bits[i]) << group << " " << i;
    field.insert_nibble(group);
    bits.insert(bits.begin() + 4 * group, 4, false);
    for (uint32_t i = 0; i < 128; ++i) ASSERT_EQ(field.get(i), bits[i]) << group << " " << i;
  }
}

TEST(DirectionalQuadtree, LeavesCoverTheSquareOnce) {
  for (const uint32_t bit_count : kBitCounts) {
    for (const uint32_t seed : {1u, 2u, 3u}) {
      const DirectionalQuadtree tree = random_tree(bit_count, seed);
      const std::vector<Leaf> leaves = leaves_of(tree);
      ASSERT_EQ(leaves.size(), tree.leaf_count());
      double area = 0;
      for (uint32_t k = 0; k < leaves.size(); ++k) {
        const Leaf& leaf = leaves[k];
        area += leaf.edge * leaf.edge;
        // Top down and bottom up find the same leaf.
        const QuadtreeCell up = tree.cell_of(tree.bits.select(k, false));
        const QuadtreeCell down =
            tree.find(Vec2(static_cast<float>(leaf.x + leaf.edge / 2), static_cast<float>(leaf.y + leaf.edge / 2)));
        for (const QuadtreeCell& cell : {up, down}) {
          EXPECT_EQ(cell.corner.x, leaf.x);
          EXPECT_EQ(cell.corner.y, leaf.y);
          EXPECT_EQ(cell.edge(), leaf.edge);
        }
        EXPECT_EQ(tree.leaves_below(up.bit), 1u);
      }
      EXPECT_EQ(area, 1.0);  // sums of powers of two are exact
      uint32_t below_root = 0;
      for (uint32_t i = 0; i < 4; ++i) below_root += tree.leaves_below(i);
      EXPECT_EQ(below_root, tree.leaf_count());
    }
  }
}

TEST(DirectionalQuadtree, SamplesFollowTheDensity) {
  constexpr int kSamples = 200000;
  for (const uint32_t bit_count : kBitCounts) {
    for (const bool stratified : {false, true}) {
      const DirectionalQuadtree tree = random_tree(bit_count, 7);
      testing::Histogram histogram(32);
      testing::Random random(bit_count);
      const testing::DirectionChart chart;
      for (int i = 0; i < kSamples; ++i) {
        const Vec2 u = random.next_2d();
        const Vec3 w = stratified ? tree.sample_stratified(u) : tree.sample(u);
        ASSERT_NEAR(glm::length(w), 1.0f, 1e-5f);
        const Vec2 p = chart.coordinates(w);
        histogram.add(static_cast<double>(p.x), static_cast<double>(p.y));
      }
      const auto pdf = [&](const Vec3& w) { return static_cast<double>(tree.pdf(w)); };
      EXPECT_GT(histogram.test(chart.density(pdf), 6, 2).p_value, testing::significance())
          << bit_count << (stratified ? " stratified" : "");
    }
  }
}

TEST(DirectionalQuadtree, DensityIntegratesToOne) {
  for (const uint32_t bit_count : kBitCounts) {
    const DirectionalQuadtree tree = random_tree(bit_count, 11);
    double sum = 0;
    for (const Leaf& leaf : leaves_of(tree)) {
      // Integrated per leaf, where the density is smooth except at folds of the map.
      sum += testing::integrate(
          [&](double x, double y) {
            const Vec3 w = direction_from_square({static_cast<float>(x), static_cast<float>(y)});
            return static_cast<double>(tree.pdf(w)) * static_cast<double>(octahedral_solid_angle(w));
          },
          {leaf.x, leaf.y, leaf.x + leaf.edge, leaf.y + leaf.edge}, 1e-7, 6);
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);  // float densities
  }
  // The map: the square covers the whole sphere.
  const double sphere = testing::integrate_square(
      [](double x, double y) {
        return static_cast<double>(
            octahedral_solid_angle(direction_from_square({static_cast<float>(x), static_cast<float>(y)})));
      },
      8, 1e-7, 6);
  EXPECT_NEAR(sphere, 4 * M_PI, 1e-3);
}

TEST(DirectionalQuadtree, StratifiedSamplesKeepNeighboursTogether) {
  // One point in each of 32 × 32 cells of the unit square. Stratified sampling then gives each leaf nearly the expected
  // number of directions. Bottom-up sampling separates neighbours.
  const DirectionalQuadtree tree = random_tree(128, 5);
  const auto spread = [&](bool stratified) {
    std::map<uint32_t, int> counts;
    testing::Random random(1);
    for (int i = 0; i < 1024; ++i) {
      const Vec2 u = (Vec2(static_cast<float>(i % 32), static_cast<float>(i / 32)) + random.next_2d()) / 32.0f;
      const Vec3 w = stratified ? tree.sample_stratified(u) : tree.sample(u);
      ++counts[tree.find(square_from_direction(w)).bit];
    }
    double squares = 0;
    for (uint32_t bit = 0; bit < 128; ++bit) {
      if (!tree.bits.get(bit)) squares += (counts[bit] - 1024.0 / 97) * (counts[bit] - 1024.0 / 97);
    }
    return squares / 97;
  };
  // The variance with independent samples would be 1024/97 = 10.6.
  EXPECT_LT(spread(true), 5.0);
  EXPECT_LT(2 * spread(true), spread(false));
}

TEST(QuadtreeArray, LoadsStoredTrees) {
  for (const uint32_t bit_count : kBitCounts) {
    std::vector<uint32_t> words(3 * bit_count / 32);
    const QuadtreeArray array{mutable_view_of(words), bit_count};
    for (uint32_t i = 0; i < 3; ++i) array.store(i, random_tree(bit_count, 20 + i));
    for (uint32_t i = 0; i < 3; ++i) {
      const DirectionalQuadtree expected = random_tree(bit_count, 20 + i);
      for (uint32_t w = 0; w < BitField::kWords; ++w) EXPECT_EQ(array.load(i).bits.words[w], expected.bits.words[w]);
    }
  }
}

TEST(Quadtree, IsDistinguishedFromOtherBits) {
  for (const uint32_t bits : {32u, 64u, 96u, 128u}) {
    DirectionalQuadtree tree = uniform_quadtree(bits);
    EXPECT_TRUE(is_quadtree(tree));
    testing::Random random(bits);
    for (int i = 0; i < 200; ++i) {  // trees after adaptation
      const uint32_t place = pack_square(random.next_2d());
      QuadtreeWeights weights{};
      adapt(tree, weights, [&](uint32_t) { return DirectionSample{place, 1.0f}; }, 1, {0.1f, 4});
      ASSERT_TRUE(is_quadtree(tree)) << bits << ' ' << i;
    }
    tree.bits.words[0] = 0xffffffffu;
    EXPECT_FALSE(is_quadtree(tree));
    EXPECT_FALSE(is_quadtree({BitField{}, bits}));
    // The right number of inner nodes, but the first is one of its own children.
    DirectionalQuadtree circle{BitField{}, bits};
    for (uint32_t i = 0; i + 1 < bits / 4; ++i) circle.bits.set(4 + i);
    EXPECT_FALSE(is_quadtree(circle));
  }
  // A chain deeper than kMaxQuadtreeDepth.
  DirectionalQuadtree chain{BitField{}, 128};
  for (uint32_t i = 0; i < 31; ++i) chain.bits.set(4 * i);
  EXPECT_FALSE(is_quadtree(chain));
}

TEST(QuadtreeArray, KnowsUniformTrees) {
  for (const uint32_t bit_count : kBitCounts) {
    std::vector<uint32_t> words(20 * bit_count / 32);
    const QuadtreeArray trees{mutable_view_of(words), bit_count};
    for (uint32_t i = 0; i < trees.tree_count(); ++i)
      trees.store(i, i % 2 == 0 ? uniform_quadtree(bit_count) : random_tree(bit_count, i));
    for (uint32_t i = 0; i < trees.tree_count(); ++i) EXPECT_EQ(trees.is_uniform(i), i % 2 == 0) << bit_count;
    DirectionalQuadtree tree = uniform_quadtree(bit_count);
    QuadtreeWeights weights{};
    weights.add(tree.bit_count - 1, 1.0f);
    const MigrationChoice choice = choose_migration(tree, weights, {});
    ASSERT_TRUE(choice.found);
    migrate(tree, weights, choice.inner, choice.leaf, 0);
    trees.store(0, tree);
    EXPECT_FALSE(trees.is_uniform(0)) << bit_count;
  }
}

}  // namespace
}  // namespace relume
