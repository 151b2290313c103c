// The view of the octree that kernels read ([Dittebrandt20, §6]). Its leaves are the regions of adaptive structures.
//
// An inner node is one word. The low 8 bits mask the children that are leaves; the upper 24 are the number of the
// first inner child, which the others follow. Leaves have no words: leaf `child` of node n is number 8 n + child.
// Numbers of inner children are unused.
#pragma once

#include <bit>

#include "core/region.h"
#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Maximum number of levels below the root. Positions are quantised to 2^20 steps along each axis.
inline constexpr uint32_t kMaxOctreeDepth = 20;
inline constexpr uint32_t kMaxOctreeNodes = 1u << 24;

RELUME_HD constexpr uint32_t make_octree_node(uint32_t first_inner_child, uint32_t leaf_mask) {
  return (first_inner_child << 8) | leaf_mask;
}
RELUME_HD constexpr uint32_t octree_leaf_mask(uint32_t node) { return node & 0xffu; }
RELUME_HD constexpr uint32_t octree_first_child(uint32_t node) { return node >> 8; }

/// Node number of the inner child at `child`.
RELUME_HD constexpr uint32_t octree_inner_child(uint32_t node, uint32_t child) {
  const uint32_t inner_before = ~octree_leaf_mask(node) & ((1u << child) - 1u);
  return octree_first_child(node) + static_cast<uint32_t>(std::popcount(inner_before));
}

/// A cell: its low corner in steps of the finest level, and its depth (root: 0).
struct OctreeCell {
  UVec3 corner{0};
  uint32_t depth = 0;

  RELUME_HD uint32_t size() const { return 1u << (kMaxOctreeDepth - depth); }
};

/// The leaf of a point.
struct OctreeLeaf {
  uint32_t leaf = kNoRegion;
  uint32_t depth = 0;
};

/// The leaf from which a vertex takes estimates and the one in which it records samples. They differ on moving
/// surfaces.
struct RegionPair {
  uint32_t sample = kNoRegion;
  uint32_t store = kNoRegion;
};

struct OctreeView {
  View<const uint32_t> nodes;
  Vec3 corner{0};   ///< low corner of the cube, metres
  float scale = 0;  ///< finest steps per metre

  RELUME_HD bool empty() const { return nodes.empty(); }

  /// Coordinates in finest steps. Points outside are clamped to the cube.
  RELUME_HD UVec3 quantise(const Vec3& p) const {
    constexpr float kSteps = static_cast<float>(1u << kMaxOctreeDepth);
    const Vec3 q = (p - corner) * scale;
    // In this order, NaN becomes zero.
    const auto step = [](float x) { return static_cast<uint32_t>(relume::min(relume::max(x, 0.0f), kSteps - 1.0f)); };
    return {step(q.x), step(q.y), step(q.z)};
  }

  RELUME_HD static uint32_t child_at(const UVec3& q, uint32_t depth) {
    const uint32_t shift = kMaxOctreeDepth - 1 - depth;
    return ((q.x >> shift) & 1u) | (((q.y >> shift) & 1u) << 1) | (((q.z >> shift) & 1u) << 2);
  }

  /// Continues a traversal from `node` at `depth`.
  RELUME_HD OctreeLeaf descend(const UVec3& q, uint32_t node, uint32_t depth) const {
    for (;;) {
      const uint32_t child = child_at(q, depth++);
      const uint32_t word = nodes[node];
      if ((word >> child) & 1u) return {8 * node + child, depth};
      node = octree_inner_child(word, child);
    }
  }

  RELUME_HD OctreeLeaf find(const UVec3& q) const { return descend(q, 0, 0); }
  RELUME_HD uint32_t find(const Vec3& p) const { return empty() ? kNoRegion : find(quantise(p)).leaf; }

  /// The leaf at a random point near `q`, to hide borders. `u` in [0, 1)³ moves the point along each axis by up to
  /// half of `share` times the edge of q's leaf.
  RELUME_HD uint32_t find_near(const UVec3& q, float share, const Vec3& u) const {
    constexpr float kLast = static_cast<float>((1u << kMaxOctreeDepth) - 1u);
    const float reach = share * static_cast<float>(1u << (kMaxOctreeDepth - find(q).depth));
    UVec3 near;
    for (int axis = 0; axis < 3; ++axis) {
      const float at = static_cast<float>(q[axis]) + reach * (u[axis] - 0.5f);
      near[axis] = static_cast<uint32_t>(clamp(at, 0.0f, kLast));
    }
    return find(near).leaf;
  }

  /// Both leaves with one traversal until their paths diverge ([Dittebrandt20, §6.3]).
  RELUME_HD RegionPair find_pair(const Vec3& previous, const Vec3& current) const {
    if (empty()) return {};
    const UVec3 a = quantise(previous);
    const UVec3 b = quantise(current);
    uint32_t node = 0;
    for (uint32_t depth = 0;; ++depth) {
      const uint32_t child = child_at(a, depth);
      if (child != child_at(b, depth)) return {descend(a, node, depth).leaf, descend(b, node, depth).leaf};
      const uint32_t word = nodes[node];
      if ((word >> child) & 1u) return {8 * node + child, 8 * node + child};
      node = octree_inner_child(word, child);
    }
  }
};

}  // namespace relume
