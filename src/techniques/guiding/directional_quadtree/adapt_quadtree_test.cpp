#include "techniques/guiding/directional_quadtree/adapt_quadtree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"
#include "techniques/guiding/directional_quadtree/testing/random_tree.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::random_tree;

constexpr uint32_t kBitCounts[] = {32, 64, 96, 128};

/// Samples of the tree's density as in rendering, with the values L / pdf_w.
template <typename Radiance>
std::vector<DirectionSample> observe(const DirectionalQuadtree& tree, int count, uint32_t seed,
                                     const Radiance& radiance) {
  std::vector<DirectionSample> samples;
  testing::Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3 w = tree.sample(random.next_2d());
    samples.push_back({pack_square(square_from_direction(w)), radiance(w) / tree.pdf(w)});
  }
  return samples;
}

/// Adapts without memory, as in the paper.
template <typename Samples>
uint32_t adapt_afresh(DirectionalQuadtree& tree, const Samples& samples, uint32_t count,
                      const QuadtreeAdaption& options) {
  QuadtreeWeights forgotten{};
  return adapt(tree, forgotten, samples, count, options);
}

TEST(AdaptQuadtree, MovesTowardsASmallBrightSpotAndStopsThere) {
  const Vec3 sun = glm::normalize(Vec3(0.4f, 0.8f, 0.3f));
  const auto radiance = [&](const Vec3& w) { return glm::dot(w, sun) > 0.995f ? 1000.0f : 0.1f; };
  for (const uint32_t bit_count : kBitCounts) {
    DirectionalQuadtree tree = uniform_quadtree(bit_count);
    const float before = tree.pdf(sun);
    uint32_t moved_late = 0;
    for (uint32_t frame = 0; frame < 120; ++frame) {
      const auto samples = observe(tree, 2000, frame, radiance);
      const uint32_t moved = adapt_afresh(tree, [&](uint32_t i) { return samples[i]; }, 2000, {});
      if (frame >= 100) moved_late += moved;
    }
    EXPECT_GT(tree.pdf(sun), 8 * before) << bit_count;
    EXPECT_LE(moved_late, 10u) << bit_count;  // of twenty: a stability of 0.1 prevents oscillation
    EXPECT_TRUE(is_quadtree(tree));
  }
}

TEST(AdaptQuadtree, FollowsTheLightWhenItMoves) {
  Vec3 sun = glm::normalize(Vec3(1, 0.2f, 0.1f));
  const auto radiance = [&](const Vec3& w) { return glm::dot(w, sun) > 0.98f ? 100.0f : 0.5f; };
  const auto frames_until_adapted = [&](uint32_t migrations) {
    sun = glm::normalize(Vec3(1, 0.2f, 0.1f));
    DirectionalQuadtree tree = uniform_quadtree(128);
    for (uint32_t frame = 0; frame < 80; ++frame) {
      const auto samples = observe(tree, 1000, frame, radiance);
      adapt_afresh(tree, [&](uint32_t i) { return samples[i]; }, 1000, {0.1f, migrations});
    }
    const float adapted = tree.pdf(sun);
    sun = -sun;
    int frames = 0;
    while (tree.pdf(sun) < 0.5f * adapted && frames < 200) {
      const auto samples = observe(tree, 1000, 1000 + static_cast<uint32_t>(frames++), radiance);
      adapt_afresh(tree, [&](uint32_t i) { return samples[i]; }, 1000, {0.1f, migrations});
    }
    return frames;
  };
  const int one = frames_until_adapted(1);
  const int four = frames_until_adapted(4);
  EXPECT_LT(one, 40);
  EXPECT_LT(four, one);  // the purpose of several migrations
}

TEST(AdaptQuadtree, WeightsMoveWithTheNodes) {
  // After each migration, the sums at the leaves must equal those of a new count.
  for (const uint32_t bit_count : kBitCounts) {
    DirectionalQuadtree tree = random_tree(bit_count, 9);
    std::vector<DirectionSample> samples;
    testing::Random random(2);
    for (int i = 0; i < 3000; ++i) samples.push_back({pack_square(random.next_2d()), 1.0f});
    const auto count_from_scratch = [&] {
      QuadtreeWeights w{};
      for (const DirectionSample& s : samples) w.add(tree.find(unpack_square(s.direction)).bit, 1.0f);
      return w;
    };
    for (int step = 0; step < 50; ++step) {
      QuadtreeWeights w = count_from_scratch();
      const MigrationChoice choice = choose_migration(tree, w, {.stability = 1e6f});
      ASSERT_TRUE(choice.found);
      const uint32_t group = migrate(tree, w, choice.inner, choice.leaf, 0);
      const QuadtreeWeights expected = count_from_scratch();
      for (uint32_t i = 0; i < bit_count; ++i) {
        if (i >> 2 == group) continue;  // the parts of the split leaf have no sums yet
        ASSERT_EQ(w.found[i], tree.bits.get(i) ? 0.0f : expected.found[i]) << bit_count << " " << i;
      }
    }
  }
}

/// Adapts a tree in frames of `count` samples. The light is a disc whose rim has the cosine `rim`, with weak light from
/// all other directions. Returns the second moment ∫ L² / pdf_w of the mixture of tree and uniform directions, summed
/// over adapted frames.
double adapted_moment(const QuadtreeAdaption& options, float rim, uint32_t count) {
  const Vec3 sun = glm::normalize(Vec3(0.4f, 0.8f, 0.3f));
  const auto radiance = [&](const Vec3& w) {
    return glm::dot(w, sun) > rim ? 100.0f : 0.5f + 0.4f * std::sin(40 * w.x);
  };
  const auto mixed = [](const DirectionalQuadtree& tree, const Vec3& w) {
    return 0.5f * (0.25f * kInvPi + tree.pdf(w));
  };
  DirectionalQuadtree tree = uniform_quadtree(128);
  QuadtreeWeights w{};
  testing::Random random(3);
  double sum = 0;
  for (uint32_t frame = 0; frame < 600; ++frame) {
    std::vector<DirectionSample> samples;
    for (uint32_t i = 0; i < count; ++i) {
      const bool guided = random.next() < 0.5f;
      const Vec3 d = guided ? tree.sample(random.next_2d()) : random.direction();
      samples.push_back({pack_square(square_from_direction(d)), radiance(d) / mixed(tree, d)});
    }
    if (!(options.kept > 0.0f)) w = {};
    adapt(
        tree, w, [&](uint32_t i) { return samples[i]; }, count, options);
    EXPECT_TRUE(is_quadtree(tree));
    constexpr uint32_t kEdge = 128;
    for (uint32_t i = 0; frame >= 300 && frame % 10 == 0 && i < kEdge * kEdge; ++i) {
      const Vec2 p(static_cast<float>(i % kEdge) + 0.5f, static_cast<float>(i / kEdge) + 0.5f);
      const Vec3 d = direction_from_square(p / static_cast<float>(kEdge));
      sum += static_cast<double>(sqr(radiance(d)) / mixed(tree, d) * octahedral_solid_angle(d));
    }
  }
  return sum;
}

TEST(AdaptQuadtree, MemoryHelpsWithFewSamplesPerFrame) {
  // Of twenty samples per frame, one in fifty would hit the light with uniform directions.
  EXPECT_LT(adapted_moment({.kept = 8.0f / 9}, 0.96f, 20), 0.8 * adapted_moment({.kept = 0}, 0.96f, 20));
}

TEST(AdaptQuadtree, ASpreadCatchesTheRimOfASmallLight) {
  // A disc of 10 degrees, whose parts in coarse leaves contribute most of the second moment.
  const QuadtreeAdaption memory{.migrations = 4, .kept = 8.0f / 9};
  QuadtreeAdaption spread = memory;
  spread.spread = 1;
  EXPECT_LT(adapted_moment(spread, 0.9962f, 60), 0.5 * adapted_moment(memory, 0.9962f, 60));
}

TEST(AdaptQuadtree, SpreadReachesNeighboursThatAreNotFiner) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const DirectionalQuadtree tree = random_tree(128, seed);
    testing::Random random(seed);
    const QuadtreeCell from = tree.find(random.next_2d());
    QuadtreeWeights now{};
    now.add(from.bit, 8.0f);
    QuadtreeWeights w{};
    add_spread(tree, w, now, 0.5f);
    double around = 0;
    for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
      if (bit == from.bit || !(w.found[bit] > 0.0f)) continue;
      const QuadtreeCell to = tree.cell_of(bit);
      EXPECT_LE(to.depth, from.depth);
      EXPECT_EQ(w.largest[bit], w.found[bit]);
      around += static_cast<double>(w.found[bit]);
    }
    EXPECT_EQ(w.found[from.bit], 8.0f);
    EXPECT_LE(around, 4.0);
  }
  // If all leaves around have the same size, each of the eight receives its part.
  const DirectionalQuadtree even = uniform_quadtree(128);
  const QuadtreeCell from = even.find(Vec2(0.8f, 0.8f));
  QuadtreeWeights now{};
  now.add(from.bit, 8.0f);
  QuadtreeWeights w{};
  add_spread(even, w, now, 1);
  int parts = 0;
  for (uint32_t bit = 0; bit < even.bit_count; ++bit) parts += bit != from.bit && w.found[bit] > 0.0f ? 1 : 0;
  EXPECT_EQ(parts, 8);
  // Beyond the border of the square, the neighbour is the one on the sphere.
  QuadtreeWeights beyond{};
  QuadtreeWeights at_border{};
  at_border.add(even.find(Vec2(0.99f, 0.7f)).bit, 8.0f);
  add_spread(even, beyond, at_border, 1);
  EXPECT_GT(beyond.found[even.find(Vec2(0.99f, 0.3f)).bit], 0.0f);
}

/// Depths and corners of all inner nodes except the root.
std::set<std::tuple<uint32_t, float, float>> inner_nodes(const DirectionalQuadtree& tree) {
  std::set<std::tuple<uint32_t, float, float>> nodes;
  for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
    const QuadtreeCell cell = tree.cell_of(bit);
    if (tree.bits.get(bit)) nodes.insert({cell.depth, cell.corner.x, cell.corner.y});
  }
  return nodes;
}

TEST(AdaptQuadtree, NeverJoinsNodesSplitInTheSameCall) {
  // Leaves beside a bright one have a weight, but no samples that determine the weights of their parts.
  for (const float kept : {0.0f, 0.9f}) {
    DirectionalQuadtree tree = uniform_quadtree(128);
    uint32_t all_moved = 0;
    for (uint32_t frame = 0; frame < 40; ++frame) {
      const auto samples = observe(tree, 400, frame, [](const Vec3& w) {
        return w.x > 0.999f ? 1e4f : w.x < 0 ? 1.0f : 0.0f;
      });
      const auto before = inner_nodes(tree);
      QuadtreeWeights w{};
      const uint32_t moved =
          adapt(tree, w, [&](uint32_t i) { return samples[i]; }, 400, {.migrations = 8, .kept = kept, .spread = 1});
      uint32_t split = 0;
      for (const auto& node : inner_nodes(tree)) split += before.count(node) == 0 ? 1 : 0;
      EXPECT_EQ(split, moved) << frame;
      all_moved += moved;
    }
    EXPECT_GT(all_moved, 10u);
  }
}

TEST(AdaptQuadtree, OneRememberedBrightSampleAttractsNoLeaves) {
  DirectionalQuadtree tree = uniform_quadtree(128);
  const DirectionSample bright{0x40008000u, 1000.0f};
  QuadtreeWeights w{};
  EXPECT_EQ(adapt(tree, w, [&](uint32_t) { return bright; }, 1, {.kept = 0.9f}), 0u);
  for (int frame = 0; frame < 20; ++frame)
    EXPECT_EQ(adapt(tree, w, [&](uint32_t) { return bright; }, 0, {.kept = 0.9f}), 0u);
  EXPECT_EQ(adapt(tree, w, [&](uint32_t) { return bright; }, 2, {.kept = 0.9f}), 1u);  // but two bright samples do
  // Nor does it attract leaves around it, even if a coarse leaf contains several of the squares beside a fine one.
  for (int i = 0; i < 64; ++i) {
    const Vec2 place((static_cast<float>(i % 8) + 0.9f) / 8, (static_cast<float>(i / 8) + 0.4f) / 8);
    const DirectionSample single{pack_square(place), 1000.0f};
    DirectionalQuadtree even = uniform_quadtree(128);
    QuadtreeWeights fresh{};
    EXPECT_EQ(adapt(even, fresh, [&](uint32_t) { return single; }, 1, {.kept = 0.9f, .spread = 1}), 0u);
  }
}

TEST(AdaptQuadtree, KeepsTheTreeWithoutSamplesOrImprovement) {
  DirectionalQuadtree tree = uniform_quadtree(64);
  const std::vector<DirectionSample> bad{{0, 0.0f}, {1, -1.0f}, {2, kInfinity}, {3, std::nanf("")}, {4, 1e30f}};
  EXPECT_EQ(adapt_afresh(tree, [&](uint32_t i) { return bad[i]; }, 5, {}), 0u);
  EXPECT_EQ(adapt_afresh(tree, [&](uint32_t i) { return bad[i]; }, 0, {}), 0u);
  // Uniform light with many samples per leaf: no leaf has ten times the sum of a node.
  const auto samples = observe(tree, 20000, 5, [](const Vec3&) { return 1.0f; });
  EXPECT_EQ(adapt_afresh(tree, [&](uint32_t i) { return samples[i]; }, 20000, {}), 0u);
}

TEST(AdaptQuadtree, StaysWithinTheMaximumDepth) {
  DirectionalQuadtree tree = uniform_quadtree(128);
  const std::vector<DirectionSample> sample{{0x80008000u, 1.0f}};
  for (int i = 0; i < 40; ++i) adapt_afresh(tree, [&](uint32_t) { return sample[0]; }, 1, {});
  EXPECT_EQ(tree.find(unpack_square(sample[0].direction)).depth, kMaxQuadtreeDepth);
}

}  // namespace
}  // namespace relume
