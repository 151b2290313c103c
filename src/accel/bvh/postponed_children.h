// The host's stack of a traversal. Its traversals test the boxes of a node in vector registers.
#pragma once

#include <bit>

#include "accel/bvh/box_ray.h"

namespace relume {

/// Postponed children with the distances at which the ray enters them, the nearest of each node last.
class PostponedChildren {
 public:
  /// Replaces `child`, a node, by the nearest of its children that the ray enters before `t_max`, and postpones the
  /// others. Returns false if it enters none. `size`: number of postponed children, 0 at first.
  RELUME_HD_INLINE bool descend(const View<const BvhNode>& nodes, const BoxRay& boxes, float t_max, uint32_t& size,
                                BvhChild& child) {
    const BvhNode& node = nodes[child.node_index()];
    float entries[kBvhWidth];
    uint32_t entered = boxes.enter_at_once(node, t_max, entries);
    if (entered == 0) return false;
    auto i = static_cast<uint32_t>(std::countr_zero(entered));
    entered &= entered - 1;
    Entry nearest{node.children[i], entries[i]};
    const uint32_t first = size;
    for (; entered != 0; entered &= entered - 1) {
      i = static_cast<uint32_t>(std::countr_zero(entered));
      Entry next{node.children[i], entries[i]};
      if (next.entry < nearest.entry) {
        const Entry swapped = nearest;
        nearest = next;
        next = swapped;
      }
      uint32_t at = size++;
      for (; at > first && stack_[at - 1].entry < next.entry; --at) stack_[at] = stack_[at - 1];
      stack_[at] = next;
    }
    child = nearest.child;
    return true;
  }

  /// Removes the last child. Returns false if the ray enters it after `t_max`.
  RELUME_HD_INLINE bool pop(const View<const BvhNode>&, const BoxRay&, float t_max, uint32_t& size, BvhChild& child) {
    const Entry& last = stack_[--size];
    child = last.child;
    return last.entry <= t_max;
  }

 private:
  struct Entry {
    BvhChild child;
    float entry;
  };
  Entry stack_[(kBvhWidth - 1) * kBvhDepth];
};

}  // namespace relume
