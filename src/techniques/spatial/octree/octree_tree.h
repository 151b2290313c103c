// The topology of an octree with its links, and the passes that build the next frame's tree from it
// ([Dittebrandt20, §6.2]): mark, rebuild, augment. Owners of data per leaf do the fourth pass, populate, along
// OctreeLinks::previous.
#pragma once

#include <iosfwd>
#include <vector>

#include "core/array.h"
#include "frame/launch.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

/// A region with more than `split` samples is split. Eight sibling regions with a total below `collapse` are joined.
struct OctreeThresholds {
  uint32_t collapse = 2048;
  uint32_t split = 4096;
  uint32_t max_depth = 16;
};

/// Links of nodes and leaves. Unused leaf slots have kNoRegion everywhere.
struct OctreeLinks {
  explicit OctreeLinks(Memory& memory) : parents(memory), neighbours(memory), previous(memory) {}

  Array<uint32_t> parents;     ///< parent by node; the root's is the root
  Array<uint32_t> neighbours;  ///< 6 per leaf, −x +x −y +y −z +z: the leaf that covers the face, or kNoRegion
  Array<uint32_t> previous;    ///< origin by leaf: the leaf of the previous tree from which data is copied
};

/// A cell in world space.
struct OctreeCube {
  Vec3 corner{0};  ///< low corner, metres
  float edge = 0;  ///< metres
};

/// Owns nodes and links.
class OctreeTree {
 public:
  /// A root with eight leaves over the cube around `center`; `edge` in metres.
  OctreeTree(const Vec3& center, float edge, Memory& memory = host_memory());

  OctreeView view() const;
  uint32_t node_count() const { return static_cast<uint32_t>(nodes_.size()); }
  /// Upper bound of leaf numbers; some numbers are unused.
  uint32_t leaf_slots() const { return 8 * node_count(); }
  uint32_t leaf_count() const;
  bool is_leaf(uint32_t slot) const { return (octree_leaf_mask(nodes_.read()[slot / 8]) >> (slot % 8)) & 1u; }
  OctreeCube cube_of(uint32_t slot) const;   ///< cube of a leaf
  std::vector<uint8_t> leaf_depths() const;  ///< depths by slot; meaningless for unused slots
  uint32_t depth() const { return depth_; }  ///< depth of the deepest leaf
  const OctreeLinks& links() const { return links_; }
  size_t memory_bytes() const;
  void save(std::ostream& out) const;
  void load(std::istream& in);

  /// The next frame's tree for this frame's number of samples per leaf slot (`counts`). Its links refer to this tree.
  OctreeTree adapted(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds) const;

 private:
  explicit OctreeTree(Memory& memory) : nodes_(memory), links_(memory) {}
  /// Computes the links. `run`: runs a kernel for a number of elements × 1.
  template <typename Run>
  void augment(const OctreeTree& previous, View<const uint32_t> counts, const Run& run);
  void measure_depth();

  Vec3 corner_{0};
  float scale_ = 0;
  uint32_t depth_ = 1;
  Array<uint32_t> nodes_;
  OctreeLinks links_;
};

/// Marks leaves to split and nodes to join: a bit per child in `split`, a flag per node in `collapse`.
struct OctreeMarkKernel {
  View<const uint32_t> nodes;
  View<const uint8_t> depths;  ///< depth by node
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

/// Writes the parent of each inner node.
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

/// Reconstructs the cell of each leaf from the parents. Then looks up its neighbours in this tree and its origin in
/// the previous one.
struct OctreeLeafLinksKernel {
  OctreeView tree;
  OctreeView previous_tree;
  View<const uint32_t> parents;
  View<const uint32_t> previous_counts;
  View<uint32_t> neighbours;
  View<uint32_t> previous;

  RELUME_HD void operator()(uint32_t slot, uint32_t) const;
};

/// The cell of leaf `slot`, found by walking up the parents.
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

/// The leaf of `tree` that covers `q` and is no deeper than `depth`. Where the tree is finer, returns kNoRegion and
/// sets `inner` to the node of that depth.
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
    // A difference below zero wraps around to a coordinate that is out of range, too.
    coordinate += face % 2 == 0 ? 0u - cell.size() : cell.size();
    if (coordinate >> kMaxOctreeDepth) continue;
    neighbours[6 * slot + face] = octree_leaf_no_deeper(tree, q, cell.depth, &inner);
  }
  previous[slot] = octree_leaf_no_deeper(previous_tree, cell.corner, cell.depth, &inner);
  if (previous[slot] != kNoRegion) return;
  // Joined from eight leaves: the origin is the one with most samples.
  uint32_t largest = 0;
  for (uint32_t child = 1; child < 8; ++child) {
    if (previous_counts[8 * inner + child] > previous_counts[8 * inner + largest]) largest = child;
  }
  previous[slot] = 8 * inner + largest;
}

}  // namespace relume
