#include "accel/embree/tree_builder.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/hash.h"

namespace relume::embree {
namespace {

BuiltTree::Primitives random_boxes(unsigned count) {
  BuiltTree::Primitives list;
  for (unsigned i = 0; i < count; ++i) {
    const auto at = [&](unsigned axis) { return to_unit_float(hash(i, axis)); };
    list.push_back({at(0), at(1), at(2), 5, at(0) + 0.01f, at(1) + 0.01f, at(2) + 0.01f, i});
  }
  return list;
}

/// Counts the leaves' primitives, and returns the depth.
unsigned visit(const BuildNode& node, std::vector<unsigned>& visits) {
  unsigned depth = 0;
  if (node.is_leaf) {
    const auto& leaf = static_cast<const BuildLeaf&>(node);
    for (unsigned i = 0; i < leaf.count; ++i) {
      EXPECT_EQ(leaf.primitives[i].geometry, 5u);
      ++visits[leaf.primitives[i].primitive];
    }
    return 0;
  }
  const auto& inner = static_cast<const BuildInner&>(node);
  EXPECT_GE(inner.count, 2u);
  for (unsigned i = 0; i < inner.count; ++i) depth = std::max(depth, visit(*inner.children[i], visits));
  return depth + 1;
}

TEST(BuiltTree, HasEveryPrimitiveOnce) {
  Device device;
  for (const unsigned count : {0u, 1u, 2u, 5u, 1000u}) {
    const BuiltTree tree(device, [&] { return random_boxes(count); }, {.max_primitives = 3, .max_depth = 24});
    EXPECT_EQ(tree.root() != nullptr, count > 0);
    std::vector<unsigned> visits(count, 0);
    if (tree.root()) {
      EXPECT_LE(visit(*tree.root(), visits), 24u);
    }
    EXPECT_EQ(visits, std::vector<unsigned>(count, 1));
  }
}

/// Embree fails: eight levels of four children, with three boxes per leaf, hold at most 196,608 boxes.
TEST(BuiltTree, FallsBackToABalancedTree) {
  constexpr unsigned kCount = 250'000;
  Device device;
  int lists = 0;
  const auto list = [&] {
    ++lists;
    return random_boxes(kCount);
  };
  const BuiltTree tree(device, list, {.max_primitives = 3, .max_depth = 8});
  EXPECT_EQ(lists, 2);
  std::vector<unsigned> visits(kCount, 0);
  EXPECT_EQ(visit(*tree.root(), visits), 9u);
  EXPECT_EQ(visits, std::vector<unsigned>(kCount, 1));
}

}  // namespace
}  // namespace relume::embree
