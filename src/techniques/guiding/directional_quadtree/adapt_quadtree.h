// Moves leaves of a directional quadtree to the directions of the brightest samples ([Dittebrandt20, §5.1]).
#pragma once

#include "core/view.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree.h"

namespace relume {

/// A path's sample of the incident light at a vertex.
struct DirectionSample {
  uint32_t direction;  ///< position in the unit square, 16 bits per coordinate
  float value;         ///< luminance of Li cos θ / pdf_w, with pdf_w of the whole mixture
};

struct QuadtreeAdaption {
  float stability = 0.1f;   ///< factor of a leaf's sum, which must exceed the sum of the node that is joined
  uint32_t migrations = 1;  ///< maximum number of migrations in one call
  float kept = 0;           ///< factor of the sums of earlier calls; 0: as in the paper
  float spread = 0;         ///< share of a leaf's sum that is also added around it; 0: as in the paper

  /// Whether the samples of this call give the exact sums of a split leaf's parts, as in the paper. Of earlier sums and
  /// of those spread from around, each part inherits a quarter.
  RELUME_HD bool exact() const { return !(kept > 0.0f) && !(spread > 0.0f); }
};

/// Sums of squared contributions to leaves, at the leaves' bits; 0 at those of inner nodes. Sums that outlast a call
/// are used with more care than in the paper. A leaf is split for the squares since its parent was split, without the
/// largest one. A single bright sample therefore does not attract leaves frame after frame. Has no initialisers,
/// because it is also shared memory of a group; elsewhere, initialise it with {}.
struct QuadtreeWeights {
  static constexpr uint32_t kBits = BitField::kWords * 32;
  static constexpr float kMost = 1e37f;  ///< limit of sums; eight of them are still finite
  float found[kBits];                    ///< sum of squares since the leaf's parent was split
  float largest[kBits];                  ///< largest of these squares
  float inherited[kBits];                ///< the leaf's share of the parent's sum before it was split

  RELUME_HD void add(uint32_t bit, float square) { add(bit, square, square); }
  /// Adds a sum of squares whose largest is `most`.
  RELUME_HD void add(uint32_t bit, float squares, float most) {
    found[bit] = relume::min(found[bit] + squares, kMost);
    largest[bit] = relume::max(largest[bit], most);
  }
  RELUME_HD float held(uint32_t bit) const { return found[bit] + inherited[bit]; }
  RELUME_HD float held_by_group(uint32_t group) const {
    const uint32_t b = 4 * group;
    return held(b) + held(b + 1) + held(b + 2) + held(b + 3);
  }
  RELUME_HD void scale(float factor) {
    for (uint32_t i = 0; i < kBits; ++i) scale(i, factor);
  }
  RELUME_HD void scale(uint32_t bit, float factor) {
    found[bit] *= factor;
    largest[bit] *= factor;
    inherited[bit] *= factor;
  }
  /// Copies the sums of one bit.
  RELUME_HD void copy(uint32_t to, const QuadtreeWeights& source, uint32_t from) {
    found[to] = source.found[from];
    largest[to] = source.largest[from];
    inherited[to] = source.inherited[from];
  }
  RELUME_HD void set(uint32_t bit, float inherits) {
    found[bit] = 0;
    largest[bit] = 0;
    inherited[bit] = inherits;
  }
  /// Gives the leaf at `bit` the sums of the leaves in `group` of `source`, its children before.
  RELUME_HD void join(uint32_t bit, const QuadtreeWeights& source, uint32_t group) {
    set(bit, 0);
    for (uint32_t i = 4 * group; i < 4 * group + 4; ++i) {
      found[bit] = relume::min(found[bit] + source.found[i], kMost);
      largest[bit] = relume::max(largest[bit], source.largest[i]);
      inherited[bit] = relume::min(inherited[bit] + source.inherited[i], kMost);
    }
  }
};

/// Joins the children of the inner node at bit `inner`, which must be leaves, and splits another leaf at bit `leaf`.
/// The joined node receives the sum of its children's weights. Each part of the split leaf inherits `share` of its
/// weight. Returns the group of the new leaves.
RELUME_HD inline uint32_t migrate(DirectionalQuadtree& tree, QuadtreeWeights& w, uint32_t inner, uint32_t leaf,
                                  float share) {
  const uint32_t removed = tree.bits.rank(inner + 1);
  w.join(inner, w, removed);
  tree.bits.clear(inner);
  tree.bits.remove_nibble(removed);
  for (uint32_t i = 4 * removed; i + 4 < tree.bit_count; ++i) w.copy(i, w, i + 4);
  if (leaf > 4 * removed) leaf -= 4;
  tree.bits.set(leaf);
  const float inherits = share * w.held(leaf);
  w.set(leaf, 0);
  const uint32_t inserted = tree.bits.rank(leaf + 1);
  tree.bits.insert_nibble(inserted);
  for (uint32_t i = tree.bit_count - 1; i >= 4 * inserted + 4; --i) w.copy(i, w, i - 4);
  for (uint32_t i = 0; i < 4; ++i) w.set(4 * inserted + i, inherits);
  return inserted;
}

/// The leaf to split and the inner node whose children are joined.
struct MigrationChoice {
  uint32_t leaf = 0;
  uint32_t inner = 0;
  bool found = false;
};

/// Chooses the heaviest leaf and the lightest inner node whose children are all leaves. In a tie, the first in
/// breadth-first order is chosen.
RELUME_HD inline MigrationChoice choose_migration(const DirectionalQuadtree& tree, const QuadtreeWeights& w,
                                                  const QuadtreeAdaption& options) {
  MigrationChoice choice;
  float heaviest = 0;
  for (uint32_t i = 0; i < tree.bit_count; ++i) {
    const float weight = w.found[i] - (options.kept > 0.0f ? w.largest[i] : 0.0f);
    if (tree.bits.get(i) || !(weight > heaviest)) continue;
    if (tree.cell_of(i).depth >= kMaxQuadtreeDepth) continue;
    heaviest = weight;
    choice.leaf = i;
  }
  float lightest = kInfinity;
  for (uint32_t group = 1; group < tree.bit_count / 4; ++group) {
    if (tree.bits.nibble(group) != 0 || choice.leaf >> 2 == group) continue;
    const float sum = w.held_by_group(group);
    if (sum < lightest) {
      lightest = sum;
      choice.inner = tree.bits.select(group - 1, true);
    }
  }
  choice.found = heaviest > 0.0f && options.stability * heaviest > lightest;
  return choice;
}

inline constexpr uint32_t kNoLeaf = ~0u;  ///< not a bit of a tree

/// Bit of the leaf that receives the square of the sample; kNoLeaf if the value is not positive or its square not
/// finite.
RELUME_HD inline uint32_t leaf_of(const DirectionalQuadtree& tree, const DirectionSample& s) {
  const bool counts = s.value > 0.0f && is_finite(s.value * s.value);
  return counts ? tree.find(unpack_square(s.direction)).bit : kNoLeaf;
}

/// Adds the squares of `count` samples to the leaves, or only to those of one group.
template <typename Samples>
RELUME_HD inline void add_squares(const DirectionalQuadtree& tree, QuadtreeWeights& w, const Samples& samples,
                                  uint32_t count, uint32_t only_group = ~0u) {
  for (uint32_t i = 0; i < count; ++i) {
    const DirectionSample s = samples(i);
    const uint32_t bit = leaf_of(tree, s);
    if (bit != kNoLeaf && (only_group == ~0u || bit >> 2 == only_group)) w.add(bit, s.value * s.value);
  }
}

/// The leaves that receive parts of a leaf's sum.
struct QuadtreeSpread {
  uint32_t count;
  uint32_t leaves[8];
  float parts[8];

  /// Finds the leaves in the eight squares of the leaf's size around it. Each square adds share / 8, unless finer
  /// leaves exist there. A coarse leaf that contains several of them receives their parts at once, as one largest
  /// square.
  RELUME_HD void find(const DirectionalQuadtree& tree, float share, uint32_t bit) {
    const QuadtreeCell cell = tree.cell_of(bit);
    const float edge = cell.edge();
    count = 0;
    for (int i = 0; i < 9; ++i) {
      if (i == 4) continue;  // the leaf
      const Vec2 step(static_cast<float>(i % 3) - 0.5f, static_cast<float>(i / 3) - 0.5f);
      const QuadtreeCell beside = tree.find(wrap_square(cell.corner + step * edge));
      if (beside.depth > cell.depth || beside.bit == bit) continue;
      const uint32_t k = index_of(beside.bit);
      if (k == count) {
        leaves[count] = beside.bit;
        parts[count++] = 0;
      }
      parts[k] += 0.125f * share;
    }
  }

  /// Index of a leaf, or `count`.
  RELUME_HD uint32_t index_of(uint32_t leaf) const {
    uint32_t k = 0;
    while (k < count && leaves[k] != leaf) ++k;
    return k;
  }
};

/// Adds the sums of `now` to `w`, and a share of them around each leaf. The rim of a light in a coarse leaf is sampled
/// rarely, and then with a small density and a large weight. Leaves beside bright ones become fine before that happens.
RELUME_HD inline void add_spread(const DirectionalQuadtree& tree, QuadtreeWeights& w, const QuadtreeWeights& now,
                                 float share) {
  for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
    if (!(now.found[bit] > 0.0f)) continue;
    w.add(bit, now.found[bit], now.largest[bit]);
    QuadtreeSpread around;
    around.find(tree, share, bit);
    for (uint32_t k = 0; k < around.count; ++k)
      w.add(around.leaves[k], around.parts[k] * now.found[bit], around.parts[k] * now.largest[bit]);
  }
}

/// Adapts `tree` to samples; `samples(i)` is the i-th of `count`. With squares, the tree follows variance as well as
/// energy. `w`: this tree's weights after the last call, or empty ones. Returns the number of migrations.
template <typename Samples>
RELUME_HD inline uint32_t adapt(DirectionalQuadtree& tree, QuadtreeWeights& w, const Samples& samples, uint32_t count,
                                const QuadtreeAdaption& options) {
  w.scale(options.kept);
  if (options.spread > 0.0f) {
    QuadtreeWeights now{};
    add_squares(tree, now, samples, count);
    add_spread(tree, w, now, options.spread);
  } else {
    add_squares(tree, w, samples, count);
  }
  const bool exact = options.exact();
  uint32_t moved = 0;
  while (moved < options.migrations) {
    const MigrationChoice choice = choose_migration(tree, w, options);
    if (!choice.found) break;
    const uint32_t group = migrate(tree, w, choice.inner, choice.leaf, exact ? 0.0f : 0.25f);
    if (++moved < options.migrations && exact) add_squares(tree, w, samples, count, group);
  }
  return moved;
}

}  // namespace relume
