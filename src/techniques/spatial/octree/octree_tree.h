// The topology of an octree with its links, and the passes that build the next frame's tree from it
// ([Dittebrandt20, §6.2]): mark, rebuild, augment. Owners of data per leaf do the fourth pass, populate, along
// OctreeLinks::previous.
#pragma once

#include <bit>
#include <iosfwd>

#include "core/array.h"
#include "frame/launch.h"
#include "frame/primitives/primitive.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

/// A region with more than `split` samples is split. Eight sibling regions with a total below `collapse` are joined.
struct OctreeThresholds {
  uint32_t collapse = 2048;
  uint32_t split = 4096;
  uint32_t max_depth = 16;
  uint32_t max_nodes = kMaxOctreeNodes;  ///< limit on nodes; leaves are not split beyond it
};

/// Temporary memory for OctreeTree::adapted(), which callers keep between frames.
struct OctreeScratch {
  explicit OctreeScratch(Memory& memory = host_memory()) : split(memory), collapse(memory), offsets(memory) {}

  Array<uint8_t> split;     ///< by node
  Array<uint8_t> collapse;  ///< by node
  Array<uint32_t> offsets;  ///< by node: number of splits, later of inner children, in earlier nodes
  PrimitiveScratch primitives;

  size_t memory_bytes() const {
    return split.memory_bytes() + collapse.memory_bytes() + offsets.memory_bytes() + primitives.memory_bytes();
  }
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
  uint32_t depth() const { return depth_; }  ///< depth of the deepest leaf
  const OctreeLinks& links() const { return links_; }
  size_t memory_bytes() const;
  void save(std::ostream& out) const;
  void load(std::istream& in);

  /// The next frame's tree for this frame's number of samples per leaf slot (`counts`). Its links refer to this tree.
  OctreeTree adapted(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds,
                     OctreeScratch& scratch) const;
  OctreeTree adapted(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds) const {
    OctreeScratch scratch(nodes_.memory());
    return adapted(backend, counts, thresholds, scratch);
  }

  OctreeTree copy(Backend& backend) const;
  /// Writes the depth of each leaf by slot; meaningless for unused slots.
  void write_leaf_depths(Backend& backend, Array<uint8_t>& depths) const;

 private:
  explicit OctreeTree(Memory& memory) : nodes_(memory), links_(memory) {}
  /// Computes the links. `run`: runs a kernel for a number of elements × 1.
  template <typename Run>
  void augment(const OctreeTree& previous, View<const uint32_t> counts, const Run& run);
  /// Marks leaves to split and nodes to join, in `scratch`.
  void mark(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds,
            OctreeScratch& scratch) const;
  /// Writes the nodes of the next tree to `next`.
  void rebuild(Backend& backend, OctreeScratch& scratch, Array<uint32_t>& next) const;

  Vec3 corner_{0};
  float scale_ = 0;
  uint32_t depth_ = 1;
  Array<uint32_t> nodes_;
  OctreeLinks links_;
};

/// Depth of each node (root: 0), by walking up the parents.
struct OctreeDepths {
  View<const uint32_t> parents;

  RELUME_HD uint32_t operator()(size_t node) const {
    uint32_t depth = 0;
    for (; node != 0; node = parents.data[node]) ++depth;
    return depth;
  }
};

/// Writes the depth of each leaf slot.
struct OctreeLeafDepthsKernel {
  OctreeDepths depths;
  View<uint8_t> leaf_depths;

  RELUME_HD void operator()(uint32_t slot, uint32_t) const {
    leaf_depths[slot] = static_cast<uint8_t>(depths(slot / 8) + 1);
  }
};

/// Marks leaves to split and nodes to join: a bit per child in `split`, a flag per node in `collapse`.
struct OctreeMarkKernel {
  View<const uint32_t> nodes;
  OctreeDepths depths;
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
      if (((leaves >> child) & 1u) && count > thresholds.split) marked |= 1u << child;
    }
    if (marked != 0 && depths(node) + 1u >= thresholds.max_depth) marked = 0;
    const bool joined = node != 0 && leaves == 0xffu && sum < thresholds.collapse;
    split[node] = joined ? uint8_t{0} : static_cast<uint8_t>(marked);
    collapse[node] = joined ? 1 : 0;
  }
};

/// Number of each node's leaves to split.
struct OctreeSplits {
  View<const uint8_t> split;

  RELUME_HD uint32_t operator()(size_t node) const { return static_cast<uint32_t>(std::popcount(split.data[node])); }
};

/// Keeps the first `room` leaves to split, in the order of their numbers.
struct OctreeLimitSplitsKernel {
  View<const uint32_t> offsets;  ///< number of leaves to split in earlier nodes, by node
  uint32_t room = 0;
  View<uint8_t> split;

  RELUME_HD void operator()(uint32_t node, uint32_t) const {
    uint32_t kept = 0;
    uint32_t offset = offsets[node];
    for (uint32_t child = 0; child < 8; ++child) {
      if (((split[node] >> child) & 1u) && offset++ < room) kept |= 1u << child;
    }
    split[node] = static_cast<uint8_t>(kept);
  }
};

/// The children of a remaining node in the next tree.
struct OctreeChanges {
  View<const uint32_t> nodes;
  View<const uint8_t> split;
  View<const uint8_t> collapse;

  /// Mask of the children that are leaves in the next tree.
  RELUME_HD uint32_t leaf_mask(uint32_t node) const {
    const uint32_t word = nodes[node];
    uint32_t mask = octree_leaf_mask(word) & ~uint32_t{split[node]};
    for (uint32_t child = 0; child < 8; ++child) {
      if (!((word >> child) & 1u) && collapse[octree_inner_child(word, child)] != 0) mask |= 1u << child;
    }
    return mask;
  }
  /// Number of inner children in the next tree; 0 for a node that is joined.
  RELUME_HD uint32_t operator()(size_t node) const {
    const auto n = static_cast<uint32_t>(node);
    return collapse[n] != 0 ? 0u : 8u - static_cast<uint32_t>(std::popcount(leaf_mask(n)));
  }
};

/// Writes the words of the next tree's nodes, which are numbered breadth-first; one call per node of this tree. Nodes
/// of a depth keep their order, so the children of a node follow those of all earlier nodes.
struct OctreeRebuildKernel {
  OctreeChanges changes;
  View<const uint32_t> offsets;  ///< number of inner children of all earlier nodes
  View<uint32_t> next;

  RELUME_HD void operator()(uint32_t node, uint32_t) const {
    if (node == 0) next[0] = word_of(0);
    if (changes.collapse[node] != 0) return;
    const uint32_t word = changes.nodes[node];
    const uint32_t mask = changes.leaf_mask(node);
    uint32_t offset = 1 + offsets[node];
    for (uint32_t child = 0; child < 8; ++child) {
      if ((mask >> child) & 1u) continue;
      const bool was_leaf = (word >> child) & 1u;
      next[offset++] = was_leaf ? make_octree_node(0, 0xffu) : word_of(octree_inner_child(word, child));
    }
  }

 private:
  RELUME_HD uint32_t word_of(uint32_t node) const {
    const uint32_t mask = changes.leaf_mask(node);
    return make_octree_node(mask == 0xffu ? 0u : 1 + offsets[node], mask);
  }
};

/// Writes the parent of each inner node, and of the root.
struct OctreeParentsKernel {
  View<const uint32_t> nodes;
  View<uint32_t> parents;

  RELUME_HD void operator()(uint32_t node, uint32_t) const {
    const uint32_t word = nodes[node];
    if (node == 0) parents[0] = 0;
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
