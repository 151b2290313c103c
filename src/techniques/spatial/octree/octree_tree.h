// The topology of one octree with its links, and the four passes that make the next frame's from it
// ([Dittebrandt20, §6.2]): mark, rebuild, augment, populate. Populating is up to whoever stores something per leaf; the
// links say from where.
#pragma once

#include <iosfwd>
#include <vector>

#include "frame/launch.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

/// When a region has too many samples or too few. A region is split above `split`, and eight are joined when they have
/// fewer than `collapse` together.
struct OctreeThresholds {
  uint32_t collapse = 2048;
  uint32_t split = 4096;
  uint32_t max_depth = 16;
};

/// Links of leaves. Numbers that are no leaf of the tree have kNoRegion everywhere.
struct OctreeLinks {
  std::vector<uint32_t> parents;     ///< by node: the node above; the root's is itself
  std::vector<uint32_t> neighbours;  ///< 6 a leaf, −x +x −y +y −z +z: the leaf that covers the face, or kNoRegion
  std::vector<uint32_t> previous;    ///< by leaf: the leaf of the tree before that it stems from
};

/// Owns nodes and links.
class OctreeTree {
 public:
  /// A root with eight leaves over the cube of edge `edge` about `center`.
  OctreeTree(const Vec3& center, float edge);

  OctreeView view() const;
  uint32_t node_count() const { return static_cast<uint32_t>(nodes_.size()); }
  /// Leaves are numbered below this; some numbers are unused.
  uint32_t leaf_slots() const { return 8 * node_count(); }
  uint32_t leaf_count() const;
  std::vector<uint8_t> leaf_depths() const;  ///< by slot; those of unused slots say nothing
  uint32_t depth() const { return depth_; }  ///< of the deepest leaf
  const OctreeLinks& links() const { return links_; }
  size_t memory_bytes() const;
  void save(std::ostream& out) const;
  void load(std::istream& in);

  /// The tree for the next frame from this frame's samples a leaf (`counts`, one a slot). Links of the result refer to
  /// this tree.
  OctreeTree adapted(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds) const;

 private:
  OctreeTree() = default;
  void augment(Backend& backend, const OctreeTree& previous, View<const uint32_t> counts);

  Vec3 corner_{0};
  float scale_ = 0;
  uint32_t depth_ = 1;
  std::vector<uint32_t> nodes_;
  OctreeLinks links_;
};

/// Which leaves are split and which nodes are joined: one bit a child in `split`, one flag a node in `collapse`.
struct OctreeMarkKernel {
  View<const uint32_t> nodes;
  View<const uint8_t> depths;  ///< by node
  View<const uint32_t> counts;
  OctreeThresholds thresholds;
  View<uint8_t> split;
  View<uint8_t> collapse;

  RELUME_HD void operator()(uint32_t node, uint32_t) const {
    const uint32_t leaves = octree_leaf_mask(nodes[node]);
    uint32_t marked = 0;
    uint64_t sum = 0;
    for (uint32_t child = 0; child < 8; ++child) {
      const uint32_t count = counts[8 * node + child];
      sum += count;
      const bool leaf = (leaves >> child) & 1u;
      if (leaf && count > thresholds.split && depths[node] + 1u < thresholds.max_depth) marked |= 1u << child;
    }
    split[node] = static_cast<uint8_t>(marked);
    collapse[node] = node != 0 && leaves == 0xffu && sum < thresholds.collapse ? 1 : 0;
  }
};

/// Writes each node's number into its inner children's parents.
struct OctreeParentsKernel {
  View<const uint32_t> nodes;
  View<uint32_t> parents;

  RELUME_HD void operator()(uint32_t node, uint32_t) const {
    const uint32_t word = nodes[node];
    for (uint32_t child = 0; child < 8; ++child) {
      if (!((word >> child) & 1u)) parents[octree_inner_child(word, child)] = node;
    }
  }
};

/// Reconstructs each leaf's place from the parents and looks up its neighbours in this tree and its origin in the
/// previous one.
struct OctreeLeafLinksKernel {
  OctreeView tree;
  OctreeView previous_tree;
  View<const uint32_t> parents;
  View<const uint32_t> previous_counts;
  View<uint32_t> neighbours;
  View<uint32_t> previous;

  RELUME_HD void operator()(uint32_t slot, uint32_t) const;
};

/// The cell of leaf `slot`, from the links upwards.
RELUME_HD inline OctreeCell octree_cell_of(const View<const uint32_t>& nodes, const View<const uint32_t>& parents,
                                           uint32_t slot) {
  uint32_t children[kMaxOctreeDepth];
  OctreeCell cell;
  children[cell.depth++] = slot % 8;
  for (uint32_t node = slot / 8; node != 0;) {
    const uint32_t parent = parents[node];
    uint32_t child = 0;
    while (((nodes[parent] >> child) & 1u) || octree_inner_child(nodes[parent], child) != node) ++child;
    children[cell.depth++] = child;
    node = parent;
  }
  for (uint32_t level = 0; level < cell.depth; ++level) {
    const uint32_t child = children[cell.depth - 1 - level];
    const uint32_t shift = kMaxOctreeDepth - 1 - level;
    cell.corner += UVec3(child & 1u, (child >> 1) & 1u, child >> 2) << shift;
  }
  return cell;
}

/// The leaf of `tree` that covers `q` and is no deeper than `depth`; kNoRegion where the tree is finer. `inner` then
/// receives the node that is as large.
RELUME_HD inline uint32_t octree_leaf_no_deeper(const OctreeView& tree, const UVec3& q, uint32_t depth,
                                                uint32_t* inner) {
  uint32_t node = 0;
  for (uint32_t level = 0; level < depth; ++level) {
    const uint32_t child = OctreeView::child_at(q, level);
    const uint32_t word = tree.nodes[node];
    if ((word >> child) & 1u) return 8 * node + child;
    node = octree_inner_child(word, child);
  }
  *inner = node;
  return kNoRegion;
}

RELUME_HD inline void OctreeLeafLinksKernel::operator()(uint32_t slot, uint32_t) const {
  for (uint32_t face = 0; face < 6; ++face) neighbours[6 * slot + face] = kNoRegion;
  previous[slot] = kNoRegion;
  if (!((tree.nodes[slot / 8] >> (slot % 8)) & 1u)) return;
  const OctreeCell cell = octree_cell_of(tree.nodes, parents, slot);
  uint32_t inner = 0;
  for (uint32_t face = 0; face < 6; ++face) {
    UVec3 q = cell.corner;
    uint32_t& coordinate = q[static_cast<int>(face / 2)];
    // Going below zero wraps around to a number that is too large as well.
    coordinate += face % 2 == 0 ? 0u - cell.size() : cell.size();
    if (coordinate >> kMaxOctreeDepth) continue;
    neighbours[6 * slot + face] = octree_leaf_no_deeper(tree, q, cell.depth, &inner);
  }
  previous[slot] = octree_leaf_no_deeper(previous_tree, cell.corner, cell.depth, &inner);
  if (previous[slot] != kNoRegion) return;
  // Joined from eight: the one that saw most stands for all.
  uint32_t largest = 0;
  for (uint32_t child = 1; child < 8; ++child) {
    if (previous_counts[8 * inner + child] > previous_counts[8 * inner + largest]) largest = child;
  }
  previous[slot] = 8 * inner + largest;
}

}  // namespace relume
