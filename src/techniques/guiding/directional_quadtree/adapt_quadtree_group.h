// adapt() by a group of threads (frame/group.h), with the same bits: one thread adds the squares of one leaf, in the
// order of the samples.
#pragma once

#include "techniques/guiding/directional_quadtree/adapt_quadtree.h"

namespace relume {

/// Adapts one quadtree in the shared memory of a group.
struct GroupAdaption {
  static constexpr uint32_t kBits = QuadtreeWeights::kBits;
  static constexpr uint32_t kBatch = 128;  ///< samples between two barriers

  QuadtreeWeights weights;  ///< of the tree; the caller sets them

  /// As the free function adapt(), by all threads of the group. Each thread passes its own copy of the tree.
  template <typename Group, typename Samples>
  RELUME_HD uint32_t adapt(const Group& group, DirectionalQuadtree& tree, const Samples& samples, uint32_t count,
                           const QuadtreeAdaption& options) {
    group.each(kBits, [&](uint32_t bit) { weights.scale(bit, options.kept); });
    if (options.spread > 0.0f) {
      group.each(kBits, [&](uint32_t bit) { scratch_.set(bit, 0); });
      add_squares(group, tree, scratch_, samples, count);
      add_spread(group, tree, options.spread);
    } else {
      add_squares(group, tree, weights, samples, count);
    }
    const bool exact = options.exact();
    uint32_t moved = 0;
    while (moved < options.migrations) {
      const MigrationChoice choice = choose_migration(group, tree, options);
      if (!choice.found) break;
      const uint32_t split = migrate(group, tree, choice, exact ? 0.0f : 0.25f);
      if (++moved < options.migrations && exact) add_squares(group, tree, weights, samples, count, split);
    }
    return moved;
  }

 private:
  /// Adds the squares of samples to the leaves, or only to those of one group of bits.
  template <typename Group, typename Samples>
  RELUME_HD void add_squares(const Group& group, const DirectionalQuadtree& tree, QuadtreeWeights& w,
                             const Samples& samples, uint32_t count, uint32_t only_group = ~0u) {
    const uint32_t first_bit = only_group == ~0u ? 0u : 4 * only_group;
    const uint32_t bits = only_group == ~0u ? tree.bit_count : 4u;
    for (uint32_t first = 0; first < count; first += kBatch) {
      const uint32_t size = relume::min(count - first, kBatch);
      group.each(size, [&](uint32_t i) {
        const DirectionSample s = samples(first + i);
        leaves_[i] = leaf_of(tree, s);
        squares_[i] = s.value * s.value;
      });
      group.each(bits, [&](uint32_t k) {
        const uint32_t bit = first_bit + k;
        if (tree.bits.get(bit)) return;
        for (uint32_t i = 0; i < size; ++i) {
          if (leaves_[i] == bit) w.add(bit, squares_[i]);
        }
      });
    }
  }

  /// Adds the sums in `scratch_` to the weights, and a share of them around each leaf. One thread adds what one leaf
  /// receives.
  template <typename Group>
  RELUME_HD void add_spread(const Group& group, const DirectionalQuadtree& tree, float share) {
    group.each(tree.bit_count, [&](uint32_t bit) {
      if (scratch_.found[bit] > 0.0f) around_[bit].find(tree, share, bit);
    });
    group.each(tree.bit_count, [&](uint32_t leaf) {
      for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
        if (!(scratch_.found[bit] > 0.0f)) continue;
        const QuadtreeSpread& around = around_[bit];
        const uint32_t k = bit == leaf ? around.count : around.index_of(leaf);
        if (bit != leaf && k == around.count) continue;
        const float part = bit == leaf ? 1.0f : around.parts[k];
        weights.add(leaf, part * scratch_.found[bit], part * scratch_.largest[bit]);
      }
    });
  }

  /// As the free function choose_migration().
  template <typename Group>
  RELUME_HD MigrationChoice choose_migration(const Group& group, const DirectionalQuadtree& tree,
                                             const QuadtreeAdaption& options) {
    MigrationChoice choice;
    group.each(tree.bit_count, [&](uint32_t i) {
      const float weight = weights.found[i] - (options.kept > 0.0f ? weights.largest[i] : 0.0f);
      const bool splits = !tree.bits.get(i) && weight > 0.0f && tree.cell_of(i).depth < kMaxQuadtreeDepth;
      compared_[i] = splits ? weight : 0.0f;
    });
    float heaviest = 0;
    for (uint32_t i = 0; i < tree.bit_count; ++i) {
      if (!(compared_[i] > heaviest)) continue;
      heaviest = compared_[i];
      choice.leaf = i;
    }
    group.each(tree.bit_count / 4, [&](uint32_t i) {
      const bool joins = i > 0 && tree.bits.nibble(i) == 0 && choice.leaf >> 2 != i;
      compared_[i] = joins ? weights.held_by_group(i) : kInfinity;
    });
    float lightest = kInfinity;
    uint32_t joined = 0;
    for (uint32_t i = 1; i < tree.bit_count / 4; ++i) {
      if (!(compared_[i] < lightest)) continue;
      lightest = compared_[i];
      joined = i;
    }
    if (joined > 0) choice.inner = tree.bits.select(joined - 1, true);
    choice.found = heaviest > 0.0f && options.stability * heaviest > lightest;
    return choice;
  }

  /// As the free function migrate(). Builds the joined weights in `scratch_`.
  template <typename Group>
  RELUME_HD uint32_t migrate(const Group& group, DirectionalQuadtree& tree, const MigrationChoice& choice,
                             float share) {
    const uint32_t removed = tree.bits.rank(choice.inner + 1);
    group.each(tree.bit_count, [&](uint32_t i) {
      if (i == choice.inner) {
        scratch_.join(i, weights, removed);
      } else {
        scratch_.copy(i, weights, i >= 4 * removed && i + 4 < tree.bit_count ? i + 4 : i);
      }
    });
    tree.bits.clear(choice.inner);
    tree.bits.remove_nibble(removed);
    const uint32_t leaf = choice.leaf > 4 * removed ? choice.leaf - 4 : choice.leaf;
    tree.bits.set(leaf);
    const uint32_t inserted = tree.bits.rank(leaf + 1);
    tree.bits.insert_nibble(inserted);
    const float inherits = share * scratch_.held(leaf);
    group.each(tree.bit_count, [&](uint32_t i) {
      if (i == leaf || i >> 2 == inserted) {
        weights.set(i, i == leaf ? 0.0f : inherits);
      } else {
        weights.copy(i, scratch_, i > 4 * inserted ? i - 4 : i);
      }
    });
    return inserted;
  }

  QuadtreeWeights scratch_;       ///< sums of this call; during a migration, the joined weights
  QuadtreeSpread around_[kBits];  ///< of leaves with a sum
  uint32_t leaves_[kBatch];       ///< of samples
  float squares_[kBatch];
  float compared_[kBits];
};

}  // namespace relume
