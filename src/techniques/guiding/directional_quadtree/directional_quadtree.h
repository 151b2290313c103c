// A density over directions in 32 to 128 bits: a quadtree over the octahedral map whose leaves all have the same
// probability ([Dittebrandt20, §5]).
//
// Each node has one bit, in breadth-first order: 1 inner, 0 leaf. The root is always inner and has no bit, so bits
// 0 … 3 are its children. An inner node with `rank` ones up to and including its bit has the children at bits
// 4·rank … 4·rank + 3. A field of N bits always has N/4 − 1 inner nodes below the root and 3N/4 + 1 leaves.
#pragma once

#include "core/octahedral.h"
#include "core/view.h"
#include "sampling/choose.h"
#include "techniques/guiding/directional_quadtree/bit_field.h"

namespace relume {

/// Maximum depth of leaves: 4^12 parts of the sphere exceed the resolution of the bits.
inline constexpr uint32_t kMaxQuadtreeDepth = 12;

/// A square of edge 2^-depth within the unit square.
struct QuadtreeCell {
  Vec2 corner{0};
  uint32_t depth = 0;
  uint32_t bit = 0;  ///< bit of the leaf

  RELUME_HD float edge() const { return 1.0f / static_cast<float>(1u << depth); }
};

struct DirectionalQuadtree {
  BitField bits;
  uint32_t bit_count;  ///< 32, 64, 96 or 128

  RELUME_HD uint32_t leaf_count() const { return bit_count / 4 * 3 + 1; }

  /// The leaf that contains `p` of the unit square, found top down.
  RELUME_HD QuadtreeCell find(const Vec2& p) const {
    QuadtreeCell cell;
    uint32_t group = 0;
    float edge = 1;
    for (;;) {
      edge *= 0.5f;
      const uint32_t right = p.x >= cell.corner.x + edge ? 1u : 0u;
      const uint32_t upper = p.y >= cell.corner.y + edge ? 1u : 0u;
      cell.corner += Vec2(right ? edge : 0.0f, upper ? edge : 0.0f);
      ++cell.depth;
      cell.bit = 4 * group + right + 2 * upper;
      if (!bits.get(cell.bit)) return cell;
      group = bits.rank(cell.bit + 1);
    }
  }

  /// The leaf at `bit`. Its square is scaled into that of each parent, bottom up.
  RELUME_HD QuadtreeCell cell_of(uint32_t bit) const {
    QuadtreeCell cell;
    cell.bit = bit;
    for (;;) {
      cell.corner = 0.5f * (cell.corner + Vec2(bit & 1u ? 1.0f : 0.0f, bit & 2u ? 1.0f : 0.0f));
      ++cell.depth;
      const uint32_t group = bit >> 2;
      if (group == 0) return cell;
      bit = bits.select(group - 1, true);
    }
  }

  /// pdf_w of sample() for directions in a leaf of this depth: |q|³ / (4 A leaves), A = 4^-depth.
  RELUME_HD float pdf(const Vec3& w, uint32_t depth) const {
    return static_cast<float>(1u << (2 * depth)) / (static_cast<float>(leaf_count()) * octahedral_solid_angle(w));
  }
  /// pdf_w of sample() and of sample_stratified().
  RELUME_HD float pdf(const Vec3& w) const { return pdf(w, find(square_from_direction(w)).depth); }

  /// Samples a direction. `u.x` chooses the leaf; its remainder and `u.y` give the position within.
  RELUME_HD Vec3 sample(Vec2 u) const {
    const uint32_t leaf = choose_evenly(leaf_count(), u.x);
    const QuadtreeCell cell = cell_of(bits.select(leaf, false));
    return direction_from_square(cell.corner + cell.edge() * u);
  }

  /// Samples the same density top down. Neighbouring numbers mostly stay neighbours, so stratified numbers give
  /// stratified directions. Counts the leaves at each level.
  RELUME_HD Vec3 sample_stratified(Vec2 u) const {
    QuadtreeCell cell;
    uint32_t group = 0;
    float edge = 1;
    for (;;) {
      edge *= 0.5f;
      float leaves[4];
      for (uint32_t i = 0; i < 4; ++i) leaves[i] = static_cast<float>(leaves_below(4 * group + i));
      const bool right = choose(leaves[0] + leaves[2], leaves[1] + leaves[3], u.x);
      const bool upper = choose(leaves[right ? 1 : 0], leaves[right ? 3 : 2], u.y);
      cell.corner += Vec2(right ? edge : 0.0f, upper ? edge : 0.0f);
      ++cell.depth;
      cell.bit = 4 * group + (right ? 1u : 0u) + (upper ? 2u : 0u);
      if (!bits.get(cell.bit)) return direction_from_square(cell.corner + edge * u);
      group = bits.rank(cell.bit + 1);
    }
  }

  /// Number of leaves of the subtree at `bit`, whose levels are contiguous in breadth-first order.
  RELUME_HD uint32_t leaves_below(uint32_t bit) const {
    uint32_t first = bit;
    uint32_t last = bit + 1;
    uint32_t leaves = 0;
    while (first < last) {
      const uint32_t ones_before = bits.rank(first);
      const uint32_t ones = bits.rank(last) - ones_before;
      leaves += last - first - ones;
      first = 4 * (ones_before + 1);
      last = first + 4 * ones;
    }
    return leaves;
  }

 private:
  /// Chooses between two weights, true: the second, and rescales `u` to [0, 1).
  RELUME_HD static bool choose(float low, float high, float& u) { return !takes_share(low / (low + high), u); }
};

/// The most uniform tree: inner nodes come first in breadth-first order.
RELUME_HD inline DirectionalQuadtree uniform_quadtree(uint32_t bit_count) {
  DirectionalQuadtree tree{};
  tree.bit_count = bit_count;
  for (uint32_t i = 0; i + 1 < bit_count / 4; ++i) tree.bits.set(i);
  return tree;
}

/// Trees by region, each in as few words as its bits need.
struct QuadtreeArray {
  View<uint32_t> words;
  uint32_t bit_count = 128;

  RELUME_HD uint32_t words_per_tree() const { return bit_count / 32; }
  RELUME_HD uint32_t tree_count() const { return words.size / words_per_tree(); }
  /// Whether tree i is uniform_quadtree(). Its ones, of which every tree has the same number, precede all zeros.
  RELUME_HD bool is_uniform(uint32_t i) const {
    return words[i * words_per_tree()] == (1u << (bit_count / 4 - 1)) - 1u;
  }
  RELUME_HD DirectionalQuadtree load(uint32_t i) const {
    DirectionalQuadtree tree{};
    tree.bit_count = bit_count;
    for (uint32_t w = 0; w < words_per_tree(); ++w) tree.bits.words[w] = words[i * words_per_tree() + w];
    return tree;
  }
  RELUME_HD void store(uint32_t i, const DirectionalQuadtree& tree) const {
    for (uint32_t w = 0; w < words_per_tree(); ++w) words[i * words_per_tree() + w] = tree.bits.words[w];
  }
};

/// DirectionalQuadtree::pdf() of tree i. Not inlined: a copy of the tree at each of many calls would enlarge the stack
/// of kernels.
RELUME_HD_NOINLINE inline float pdf_of_quadtree(QuadtreeArray trees, uint32_t i, Vec3 w) {
  return trees.load(i).pdf(w);
}

}  // namespace relume
