// Builds the trees of the BVH.
#pragma once

#include <span>
#include <vector>

#include "accel/accel_structure.h"
#include "accel/bvh/layout.h"
#include "accel/embree/device.h"
#include "core/box.h"

namespace relume {

/// A tree in arrays of its own, with indices into these.
struct BvhTree {
  std::vector<BvhNode> nodes;
  std::vector<BvhTriangle> triangles;
  BvhChild root = BvhChild::none();
  Box bounds;  ///< of the boxes, which are larger than the triangles
};

/// Triangles to build a tree over.
struct TreePart {
  const AccelMesh* mesh = nullptr;
  uint32_t instance = kNoHit;  ///< instance of the triangles, if in world space
};

/// Tree over all triangles with finite corners. `deforms`: for refit(), and faster to build; otherwise, large triangles
/// are split among leaves. Throws Error if memory is short.
BvhTree build_tree(embree::Device& device, std::span<const TreePart> parts, bool deforms);

/// Tree over `children` and their `boxes`, at least one. `first_node`: index of its root in the final array.
BvhTree build_top_tree(embree::Device& device, std::span<const Box> boxes, std::span<const BvhChild> children,
                       uint32_t first_node);

/// Box of a triangle with the margin that BoxRay needs.
Box box_with_margin(const BvhTriangle& triangle);

/// The same for all times of an open shutter, if the mesh has keys. Between two keys, corners move along straight
/// lines. The margin is then doubled, because interpolated corners are rounded.
Box box_at_all_times(const AccelMesh& mesh, const BvhTriangle& triangle);

/// Adapts a tree without split triangles to the current vertices of its mesh, and its boxes to those of all keys.
/// `nodes`, `triangles`: those of the tree only. `first_node`, `first_triangle`: their offsets in the arrays of the
/// BVH. Returns the tree's bounds.
Box refit(const AccelMesh& mesh, std::span<BvhNode> nodes, std::span<BvhTriangle> triangles, uint32_t first_node,
          uint32_t first_triangle);

/// Adds offsets to the indices of inner nodes and triangles.
BvhChild relocated(BvhChild child, uint32_t first_node, uint32_t first_triangle);

}  // namespace relume
