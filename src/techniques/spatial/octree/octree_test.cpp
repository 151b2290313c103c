#include "techniques/spatial/octree/octree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "techniques/spatial/octree/octree_tree.h"
#include "testing/random.h"

namespace relume {
namespace {

bool is_leaf(const OctreeTree& tree, uint32_t slot) { return (tree.view().nodes[slot / 8] >> (slot % 8)) & 1u; }

/// Points on a sphere of radius 3, half of them in one small spot.
std::vector<Vec3> surface_points(int count, const Vec3& shift, uint32_t seed) {
  testing::Random random(seed);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    Vec3 d = random.direction();
    if (i % 2 == 0) d = glm::normalize(Vec3(1, 1, 1) + 0.05f * d);
    points.push_back(shift + 3.0f * d);
  }
  return points;
}

std::vector<uint32_t> count_samples(const OctreeTree& tree, const std::vector<Vec3>& points) {
  std::vector<uint32_t> counts(tree.leaf_slots(), 0);
  for (const Vec3& p : points) ++counts[tree.view().find(p)];
  return counts;
}

OctreeTree adapted(const OctreeTree& tree, const std::vector<Vec3>& points, const OctreeThresholds& thresholds,
                   int frames = 1) {
  Backend backend(1);
  OctreeTree result = tree;
  for (int i = 0; i < frames; ++i) {
    const std::vector<uint32_t> counts = count_samples(result, points);
    result = result.adapted(backend, view_of(counts), thresholds);
  }
  return result;
}

constexpr OctreeThresholds kThresholds{100, 200, 12};

bool inside(const OctreeCell& cell, const UVec3& q) {
  for (int axis = 0; axis < 3; ++axis) {
    if (q[axis] < cell.corner[axis] || q[axis] >= cell.corner[axis] + cell.size()) return false;
  }
  return true;
}

OctreeCell cell_of(const OctreeTree& tree, uint32_t slot) {
  return octree_cell_of(tree.view().nodes, tree.links().parents.view(), slot);
}

TEST(Octree, LeavesPartitionTheCube) {
  const OctreeTree tree = adapted(OctreeTree(Vec3(0), 8), surface_points(20000, Vec3(0), 1), kThresholds, 12);
  ASSERT_GT(tree.leaf_count(), 200u);
  double volume = 0;
  for (uint32_t slot = 0; slot < tree.leaf_slots(); ++slot) {
    if (!is_leaf(tree, slot)) continue;
    const OctreeCell cell = cell_of(tree, slot);
    const double edge = std::ldexp(1.0, -static_cast<int>(cell.depth));
    volume += edge * edge * edge;
    const UVec3 middle = cell.corner + cell.size() / 2;
    EXPECT_EQ(tree.view().find(middle).leaf, slot);
    EXPECT_EQ(tree.view().find(middle).depth, cell.depth);
    EXPECT_EQ(tree.view().find(cell.corner).leaf, slot);
  }
  EXPECT_EQ(volume, 1.0);  // powers of two
}

TEST(Octree, FindsTheCellThatHoldsThePoint) {
  const OctreeTree tree =
      adapted(OctreeTree(Vec3(1, 2, 3), 8), surface_points(20000, Vec3(1, 2, 3), 1), kThresholds, 10);
  for (const Vec3& p : surface_points(5000, Vec3(1, 2, 3), 9)) {
    const uint32_t leaf = tree.view().find(p);
    ASSERT_LT(leaf, tree.leaf_slots());
    ASSERT_TRUE(is_leaf(tree, leaf));
    EXPECT_TRUE(inside(cell_of(tree, leaf), tree.view().quantise(p)));
  }
  // Points outside, at infinity or not a number belong to some leaf.
  for (const Vec3& p : {Vec3(1e9f), Vec3(-1e30f, 0, 0), Vec3(kInfinity), Vec3(std::nanf(""), 0, 0)})
    EXPECT_TRUE(is_leaf(tree, tree.view().find(p)));
}

TEST(Octree, PairLookUpsMatchSingleOnes) {
  const OctreeTree tree = adapted(OctreeTree(Vec3(0), 8), surface_points(20000, Vec3(0), 1), kThresholds, 10);
  const std::vector<Vec3> a = surface_points(4000, Vec3(0), 3);
  testing::Random random(5);
  for (const Vec3& p : a) {
    for (const float step : {0.0f, 1e-3f, 0.1f, 4.0f}) {
      const Vec3 q = p + step * random.direction();
      const RegionPair pair = tree.view().find_pair(p, q);
      ASSERT_EQ(pair.sample, tree.view().find(p));
      ASSERT_EQ(pair.store, tree.view().find(q));
    }
  }
  const RegionPair none = OctreeView{}.find_pair(Vec3(0), Vec3(0));
  EXPECT_EQ(none.sample, kNoRegion);
  EXPECT_EQ(none.store, kNoRegion);
}

TEST(Octree, SplitsUntilRegionsHaveTheirSharesAndThenStays) {
  const std::vector<Vec3> points = surface_points(50000, Vec3(0), 1);
  OctreeTree tree = adapted(OctreeTree(Vec3(0), 8), points, kThresholds, 14);
  for (const uint32_t count : count_samples(tree, points)) EXPECT_LE(count, kThresholds.split);
  const OctreeTree again = adapted(tree, points, kThresholds);
  EXPECT_EQ(again.node_count(), tree.node_count());
  for (uint32_t slot = 0; slot < tree.leaf_slots(); ++slot) {  // nothing moved: each leaf is its own origin
    EXPECT_EQ(again.links().previous.read()[slot], is_leaf(tree, slot) ? slot : kNoRegion);
  }
}

TEST(Octree, GrowsOneLevelAFrame) {
  const std::vector<Vec3> points = surface_points(50000, Vec3(0), 1);
  OctreeTree tree(Vec3(0), 8);
  EXPECT_EQ(tree.depth(), 1u);
  for (uint32_t frame = 1; frame < 6; ++frame) {
    tree = adapted(tree, points, kThresholds);
    EXPECT_EQ(tree.depth(), frame + 1);
  }
}

TEST(Octree, JoinsRegionsThatWentEmpty) {
  OctreeTree tree = adapted(OctreeTree(Vec3(0), 16), surface_points(20000, Vec3(2, 0, 0), 1), kThresholds, 12);
  const uint32_t full = tree.node_count();
  tree = adapted(tree, surface_points(20000, Vec3(-2, 0, 0), 2), kThresholds, 20);
  EXPECT_LT(tree.node_count(), 1.2 * full);  // the old position of the surface has no nodes
  tree = adapted(tree, {}, kThresholds, 20);
  EXPECT_EQ(tree.node_count(), 1u);
}

TEST(Octree, StopsAtTheLargestDepth) {
  const std::vector<Vec3> one_place(5000, Vec3(0.3f, 0.2f, 0.1f));
  for (const uint32_t depth : {3u, 12u, 30u}) {
    const OctreeTree tree = adapted(OctreeTree(Vec3(0), 2), one_place, {100, 200, depth}, 40);
    EXPECT_EQ(tree.depth(), std::min(depth, kMaxOctreeDepth));
  }
}

TEST(Octree, NeighboursShareAFace) {
  const OctreeTree tree = adapted(OctreeTree(Vec3(0), 8), surface_points(20000, Vec3(0), 1), kThresholds, 12);
  uint32_t found = 0;
  for (uint32_t slot = 0; slot < tree.leaf_slots(); ++slot) {
    if (!is_leaf(tree, slot)) continue;
    const OctreeCell cell = cell_of(tree, slot);
    for (uint32_t face = 0; face < 6; ++face) {
      const int axis = static_cast<int>(face / 2);
      const uint32_t neighbour = tree.links().neighbours.read()[6 * slot + face];
      UVec3 beyond = cell.corner + cell.size() / 2;
      beyond[axis] = face % 2 == 0 ? cell.corner[axis] - 1 : cell.corner[axis] + cell.size();
      if (beyond[axis] >= 1u << kMaxOctreeDepth) {
        EXPECT_EQ(neighbour, kNoRegion);  // the border of the cube
        continue;
      }
      const OctreeLeaf expected = tree.view().find(beyond);
      if (expected.depth > cell.depth) {
        EXPECT_EQ(neighbour, kNoRegion);  // several finer neighbours: no link
      } else {
        EXPECT_EQ(neighbour, expected.leaf);
        ++found;
      }
    }
  }
  EXPECT_GT(found, tree.leaf_count());
}

TEST(Octree, FirstTreeHasItsLinks) {
  const OctreeTree tree(Vec3(0), 2);
  Backend backend(1);
  const std::vector<uint32_t> counts(8, 150);  // neither split nor joined
  const OctreeTree computed = tree.adapted(backend, view_of(counts), kThresholds);
  EXPECT_TRUE(std::ranges::equal(tree.links().neighbours.read(), computed.links().neighbours.read()));
  EXPECT_TRUE(std::ranges::equal(tree.links().previous.read(), computed.links().previous.read()));
  EXPECT_TRUE(std::ranges::equal(tree.links().parents.read(), computed.links().parents.read()));
}

TEST(Octree, LeavesLinkToThePreviousTree) {
  // The surface moves between frames, so some leaves are split and others joined.
  Backend backend(1);
  OctreeTree tree = adapted(OctreeTree(Vec3(0), 16), surface_points(20000, Vec3(2, 0, 0), 1), kThresholds, 8);
  int unchanged = 0;
  int split = 0;
  int joined = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const std::vector<uint32_t> counts =
        count_samples(tree, surface_points(20000, Vec3(2.0f - 0.4f * static_cast<float>(frame), 0, 0), 2));
    const OctreeTree next = tree.adapted(backend, view_of(counts), kThresholds);
    for (uint32_t slot = 0; slot < next.leaf_slots(); ++slot) {
      if (!is_leaf(next, slot)) continue;
      const uint32_t previous = next.links().previous.read()[slot];
      ASSERT_TRUE(previous < tree.leaf_slots() && is_leaf(tree, previous));
      const OctreeCell now = cell_of(next, slot);
      const OctreeCell before = cell_of(tree, previous);
      if (before.depth <= now.depth) {  // the same region or the one that was split
        EXPECT_TRUE(inside(before, now.corner));
        ++(before.depth == now.depth ? unchanged : split);
        EXPECT_EQ(before.depth == now.depth, counts[previous] <= kThresholds.split);
      } else {
        EXPECT_EQ(before.depth, now.depth + 1);
        EXPECT_TRUE(inside(now, before.corner));
        uint32_t largest = 0;
        for (uint32_t child = 0; child < 8; ++child) largest = std::max(largest, counts[previous / 8 * 8 + child]);
        EXPECT_EQ(counts[previous], largest);
        ++joined;
      }
    }
    tree = next;
  }
  EXPECT_GT(unchanged, 100);
  EXPECT_GT(split, 10);
  EXPECT_GT(joined, 10);
}

/// Reference: builds the next tree's nodes with a queue.
std::vector<uint32_t> rebuilt(const OctreeTree& tree, const std::vector<uint32_t>& counts, const OctreeThresholds& t) {
  const View<const uint32_t> nodes = tree.view().nodes;
  const auto joined = [&](uint32_t node) {
    const auto first = counts.begin() + static_cast<std::ptrdiff_t>(8 * node);
    return octree_leaf_mask(nodes[node]) == 0xffu && std::accumulate(first, first + 8, 0u) < t.collapse;
  };
  std::vector<uint32_t> result;
  size_t room = t.max_nodes - nodes.size;
  std::vector<uint32_t> queue{0};  // number in the old tree, or kNoRegion
  for (size_t i = 0; i < queue.size(); ++i) {
    const uint32_t old = queue[i];
    const auto first = static_cast<uint32_t>(queue.size());
    uint32_t mask = 0xff;
    for (uint32_t child = 0; old != kNoRegion && child < 8; ++child) {
      const uint32_t slot = 8 * old + child;
      if ((nodes[old] >> child) & 1u) {
        if (counts[slot] <= t.split || cell_of(tree, slot).depth >= t.max_depth || room == 0) continue;
        --room;
        queue.push_back(kNoRegion);
      } else {
        const uint32_t inner = octree_inner_child(nodes[old], child);
        if (joined(inner)) continue;
        queue.push_back(inner);
      }
      mask &= ~(1u << child);
    }
    result.push_back(make_octree_node(mask == 0xffu ? 0u : first, mask));
  }
  return result;
}

TEST(Octree, IsRebuiltBreadthFirst) {
  Backend backend(3);
  OctreeTree tree(Vec3(0), 16);
  for (int frame = 0; frame < 12; ++frame) {
    const Vec3 center(0.3f * static_cast<float>(frame), 0, 0);
    const std::vector<uint32_t> counts = count_samples(tree, surface_points(20000, center, 3));
    OctreeThresholds thresholds{50, 100, 6};
    const bool limited = frame == 2;
    if (limited) thresholds.max_nodes = tree.node_count() + 5;
    const std::vector<uint32_t> expected = rebuilt(tree, counts, thresholds);
    tree = tree.adapted(backend, view_of(counts), thresholds);
    EXPECT_TRUE(std::ranges::equal(tree.view().nodes, expected)) << frame;
    if (limited) {
      EXPECT_EQ(tree.node_count(), thresholds.max_nodes);
    }
  }
  EXPECT_GT(tree.node_count(), 100u);
}

TEST(Octree, IsTheSameWithAnyNumberOfThreads) {
  const std::vector<Vec3> points = surface_points(20000, Vec3(0), 1);
  std::vector<std::vector<uint32_t>> nodes;
  for (const int threads : {1, 3}) {
    Backend backend(threads);
    OctreeTree tree(Vec3(0), 8);
    for (int i = 0; i < 8; ++i) {
      const std::vector<uint32_t> counts = count_samples(tree, points);
      tree = tree.adapted(backend, view_of(counts), kThresholds);
    }
    nodes.emplace_back(tree.view().nodes.begin(), tree.view().nodes.end());
  }
  EXPECT_EQ(nodes[0], nodes[1]);
}

TEST(Octree, RoundTripsThroughAFileAndRejectsDamage) {
  const OctreeTree tree = adapted(OctreeTree(Vec3(0), 8), surface_points(5000, Vec3(0), 1), kThresholds, 6);
  std::stringstream file;
  tree.save(file);
  OctreeTree other(Vec3(1), 1);
  other.load(file);
  EXPECT_TRUE(file.good());
  EXPECT_EQ(other.leaf_count(), tree.leaf_count());
  EXPECT_TRUE(std::ranges::equal(other.links().neighbours.read(), tree.links().neighbours.read()));
  EXPECT_TRUE(std::ranges::equal(other.links().parents.read(), tree.links().parents.read()));
  EXPECT_EQ(other.depth(), tree.depth());
  for (const Vec3& p : surface_points(100, Vec3(0), 5)) EXPECT_EQ(other.view().find(p), tree.view().find(p));

  const std::string bytes = file.str();
  for (const size_t at : {size_t{16}, size_t{24}, size_t{29}, bytes.size() - 1}) {  // number, root, its child, last
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x41);
    std::stringstream in(damaged);
    other.load(in);
    EXPECT_TRUE(in.fail()) << at;
    EXPECT_EQ(other.leaf_count(), 8u);
  }
  std::string damaged = bytes;
  damaged.replace(0, 16, 16, '\xff');  // corner and scale are not numbers
  std::stringstream in(damaged);
  other.load(in);
  EXPECT_TRUE(in.fail());
}

}  // namespace
}  // namespace relume
