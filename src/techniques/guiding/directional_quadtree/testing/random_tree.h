// Quadtrees of random shape for tests.
#pragma once

#include "core/hash.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtree.h"

namespace relume::testing {

/// A tree after up to 300 random migrations.
inline DirectionalQuadtree random_tree(uint32_t bit_count, uint32_t seed) {
  DirectionalQuadtree tree = uniform_quadtree(bit_count);
  QuadtreeWeights w{};
  for (uint32_t step = 0; step < 300; ++step) {
    for (uint32_t i = 0; i < bit_count; ++i) w.found[i] = tree.bits.get(i) ? 0.0f : to_unit_float(hash(seed, step, i));
    const MigrationChoice choice = choose_migration(tree, w, {.stability = 1e6f});
    if (choice.found) migrate(tree, w, choice.inner, choice.leaf, 0);
  }
  return tree;
}

}  // namespace relume::testing
