// Moves leaves of a directional quadtree to where samples found most ([Dittebrandt20, §5.1]).
#pragma once

#include "core/view.h"
#include "techniques/directional_quadtree/directional_quadtree.h"

namespace relume {

/// What one path found along the direction in which it left a vertex.
struct DirectionSample {
  uint32_t direction;  ///< in the unit square, 16 bits a coordinate
  float value;         ///< Li cos θ / pdf_w, luminance; pdf_w is that of the whole mixture
};

struct QuadtreeAdaption {
  float stability = 0.1f;   ///< a leaf must hold 1 / stability times what it displaces
  uint32_t migrations = 1;  ///< at most, in one call
};

/// Sums of squared contributions to leaves, at the leaves' bits; 0 at those of inner nodes.
struct QuadtreeWeights {
  float by_bit[BitField::kWords * 32];
};

/// Collapses the inner node whose bit is `inner` (all of its children are leaves) and splits the leaf `leaf`, which is
/// none of these children. Weights move along: the collapsed node gets the sum of its children, those of the split leaf
/// are zero. Returns the group of the new leaves.
RELUME_HD inline uint32_t migrate(DirectionalQuadtree& tree, QuadtreeWeights& w, uint32_t inner, uint32_t leaf) {
  const uint32_t removed = tree.bits.rank(inner + 1);
  w.by_bit[inner] =
      w.by_bit[4 * removed] + w.by_bit[4 * removed + 1] + w.by_bit[4 * removed + 2] + w.by_bit[4 * removed + 3];
  tree.bits.clear(inner);
  tree.bits.remove_nibble(removed);
  for (uint32_t i = 4 * removed; i + 4 < tree.bit_count; ++i) w.by_bit[i] = w.by_bit[i + 4];
  if (leaf > 4 * removed) leaf -= 4;
  tree.bits.set(leaf);
  w.by_bit[leaf] = 0;
  const uint32_t inserted = tree.bits.rank(leaf + 1);
  tree.bits.insert_nibble(inserted);
  for (uint32_t i = tree.bit_count - 1; i >= 4 * inserted + 4; --i) w.by_bit[i] = w.by_bit[i - 4];
  for (uint32_t i = 0; i < 4; ++i) w.by_bit[4 * inserted + i] = 0;
  return inserted;
}

/// The two ends of a migration.
struct MigrationChoice {
  uint32_t leaf = 0;
  uint32_t inner = 0;
  bool found = false;
};

/// Heaviest leaf and lightest inner node that has only leaves below it. Ties go to the first in breadth-first order.
RELUME_HD inline MigrationChoice choose_migration(const DirectionalQuadtree& tree, const QuadtreeWeights& w,
                                                  float stability) {
  MigrationChoice choice;
  float heaviest = 0;
  for (uint32_t i = 0; i < tree.bit_count; ++i) {
    if (tree.bits.get(i) || !(w.by_bit[i] > heaviest)) continue;
    if (tree.cell_of(i).depth >= kMaxQuadtreeDepth) continue;
    heaviest = w.by_bit[i];
    choice.leaf = i;
  }
  float lightest = kInfinity;
  for (uint32_t group = 1; group < tree.bit_count / 4; ++group) {
    if (tree.bits.nibble(group) != 0 || choice.leaf >> 2 == group) continue;
    const float sum = w.by_bit[4 * group] + w.by_bit[4 * group + 1] + w.by_bit[4 * group + 2] + w.by_bit[4 * group + 3];
    if (sum < lightest) {
      lightest = sum;
      choice.inner = tree.bits.select(group - 1, true);
    }
  }
  choice.found = heaviest > 0.0f && stability * heaviest > lightest;
  return choice;
}

/// Adapts `tree` to samples; `samples(i)` is the i-th of `count`. Squares make the tree follow variance as well as
/// energy. Samples with values that are not finite and positive are left out. Returns how many leaves were split.
template <typename Samples>
RELUME_HD inline uint32_t adapt(DirectionalQuadtree& tree, const Samples& samples, uint32_t count,
                                const QuadtreeAdaption& options) {
  QuadtreeWeights w;
  for (uint32_t i = 0; i < tree.bit_count; ++i) w.by_bit[i] = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const DirectionSample s = samples(i);
    if (s.value > 0.0f && is_finite(s.value * s.value))
      w.by_bit[tree.find(unpack_square(s.direction)).bit] += s.value * s.value;
  }
  uint32_t moved = 0;
  while (moved < options.migrations) {
    const MigrationChoice choice = choose_migration(tree, w, options.stability);
    if (!choice.found) break;
    const uint32_t group = migrate(tree, w, choice.inner, choice.leaf);
    ++moved;
    if (moved == options.migrations) break;
    for (uint32_t i = 0; i < count; ++i) {  // what the split leaf held, among its parts
      const DirectionSample s = samples(i);
      if (!(s.value > 0.0f) || !is_finite(s.value * s.value)) continue;
      const uint32_t bit = tree.find(unpack_square(s.direction)).bit;
      if (bit >> 2 == group) w.by_bit[bit] += s.value * s.value;
    }
  }
  return moved;
}

}  // namespace relume
