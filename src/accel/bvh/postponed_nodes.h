// The stack of a traversal on a device, where each thread has one in local memory: 200 bytes in place of the host's
// 960.
#pragma once

#include "accel/bvh/box_ray.h"

namespace relume {

/// Nodes with postponed children, at most one for each level of the tree. Boxes of children are tested again before the
/// visit: the nodes are in a cache, and distances would take most of the memory.
class PostponedNodes {
 public:
  /// As PostponedChildren::descend(). `size`: number of nodes with postponed children, 0 at first.
  RELUME_HD_INLINE bool descend(const View<const BvhNode>& nodes, const BoxRay& boxes, float t_max, uint32_t& size,
                                BvhChild& child) {
    const BvhNode& node = nodes[child.node_index()];
    float entries[kBvhWidth];
    const uint32_t entered = boxes.enter_one_by_one(node, t_max, entries);
    if (entered == 0) return false;
    const uint32_t order = order_of(entered, entries);
    postpone(child.node_index(), order, size);
    child = node.children[order & kIndexMask];
    return true;
  }

  /// Removes the next child of the last node. Returns false if the ray enters it after `t_max`.
  RELUME_HD_INLINE bool pop(const View<const BvhNode>& nodes, const BoxRay& boxes, float t_max, uint32_t& size,
                            BvhChild& child) {
    --size;
    const uint32_t index = nodes_[size];
    const uint32_t order = orders_[size];
    const BvhNode& node = nodes[index];
    if (!boxes.enters(node, order & kIndexMask, t_max)) return false;  // the others are farther
    postpone(index, order, size);
    child = node.children[order & kIndexMask];
    return true;
  }

 private:
  // An order is a list of children, nearest first: two bits each from the lowest on, then a set bit.
  static constexpr uint32_t kIndexBits = 2;
  static constexpr uint32_t kIndexMask = kBvhWidth - 1;
  static constexpr uint32_t kEmpty = 1;
  static_assert(kBvhWidth == 1u << kIndexBits);

  RELUME_HD_INLINE static uint32_t order_of(uint32_t entered, const float (&entries)[kBvhWidth]) {
    uint32_t rank[kBvhWidth] = {0, 0, 0, 0};
    const auto is_entered = [entered](uint32_t i) { return (entered >> i & 1u) != 0; };
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      for (uint32_t k = i + 1; k < kBvhWidth; ++k) {
        const bool i_is_first = is_entered(i) && (!is_entered(k) || entries[i] <= entries[k]);
        rank[i] += i_is_first ? 0u : 1u;
        rank[k] += i_is_first ? 1u : 0u;
      }
    }
    uint32_t order = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      if (!is_entered(i)) continue;
      order |= i << kIndexBits * rank[i];
      ++count;
    }
    return order | kEmpty << kIndexBits * count;
  }

  /// Keeps the children of a node after the first in `order`, if any.
  RELUME_HD_INLINE void postpone(uint32_t node, uint32_t order, uint32_t& size) {
    const uint32_t rest = order >> kIndexBits;
    if (rest == kEmpty) return;
    nodes_[size] = node;
    orders_[size] = static_cast<uint8_t>(rest);
    ++size;
  }

  uint32_t nodes_[kBvhDepth];
  uint8_t orders_[kBvhDepth];
};

}  // namespace relume
