// Memory layout of relume's own BVH: flat arrays whose elements refer to each other by index. A BVH is copied to a
// device by copying its arrays.
//
// There are two levels. One tree holds all static triangles, in world space. Each mesh that moves, deforms or is
// instanced has its own tree, in mesh space. The leaves of a small top tree are the static tree and the instances.
#pragma once

#include <type_traits>

#include "core/key_time.h"
#include "core/vec.h"
#include "core/view.h"

namespace relume {

inline constexpr uint32_t kBvhWidth = 4;  ///< children of a node

/// Maximum number of nodes from the root of a tree to a leaf, ensured by the builder.
inline constexpr uint32_t kTopDepth = 16;
inline constexpr uint32_t kMeshDepth = 24;
inline constexpr uint32_t kBvhDepth = kTopDepth + kMeshDepth;  ///< through both levels

/// A child of a node, or the root of a tree: an inner node, a range of triangles, an instance, or nothing.
struct BvhChild {
  /// Inner nodes: their index. Leaves: bit 31, index << 4, and the number of triangles, or 0 for an instance. Nothing:
  /// all bits.
  uint32_t code;

  static constexpr uint32_t kLeaf = 0x80000000u;
  static constexpr uint32_t kMostTriangles = 14;          ///< per leaf
  static constexpr uint32_t kMostIndex = (1u << 27) - 2;  ///< of a leaf's first triangle, or of an instance

  RELUME_HD static constexpr BvhChild node(uint32_t index) { return {index}; }
  RELUME_HD static constexpr BvhChild triangles(uint32_t first, uint32_t count) { return {kLeaf | first << 4 | count}; }
  RELUME_HD static constexpr BvhChild instance(uint32_t index) { return {kLeaf | index << 4}; }
  RELUME_HD static constexpr BvhChild none() { return {0xffffffffu}; }

  RELUME_HD constexpr bool is_node() const { return (code & kLeaf) == 0; }
  RELUME_HD constexpr bool is_none() const { return code == none().code; }
  RELUME_HD constexpr bool is_instance() const { return !is_node() && count() == 0; }
  RELUME_HD constexpr bool is_triangles() const { return !is_node() && count() != 0 && !is_none(); }
  /// Index of an inner node.
  RELUME_HD constexpr uint32_t node_index() const { return code; }
  /// Index of the first triangle, or of the instance.
  RELUME_HD constexpr uint32_t index() const { return (code & ~kLeaf) >> 4; }
  RELUME_HD constexpr uint32_t count() const { return code & 15u; }
};

/// Inner node. Within one tree, children follow their parent in the array.
struct alignas(64) BvhNode {
  float bounds[6][kBvhWidth];  ///< by row: low x, high x, low y, high y, low z, high z; empty: infinity, -infinity
  BvhChild children[kBvhWidth];
};
static_assert(sizeof(BvhNode) == 128);

/// A triangle of a leaf. A triangle can be in several leaves.
struct alignas(16) BvhTriangle {
  Vec3 p0;
  uint32_t primitive;
  Vec3 p1;
  uint32_t instance;  ///< kNoHit in the trees of meshes, whose corners are in mesh space
  Vec3 p2;
  uint32_t unused;
};
static_assert(sizeof(BvhTriangle) == 48);

/// A mesh placed in the world.
struct BvhInstance {
  Vec3 to_world[4];  ///< columns of an affine matrix
  Vec3 to_mesh[3];   ///< columns of the inverse of its linear part
  Vec3 margin;    ///< by axis of mesh space: growth of boxes per metre of `reach` and of the ray's origin (box_ray.h)
  float reach;    ///< bound of the world coordinates of the mesh, metres
  BvhChild root;  ///< of the mesh's tree
  uint32_t instance;                ///< index in the scene
  uint32_t first_key = kNoKeys;     ///< in BvhView::keys; kNoKeys: rests, else `to_mesh` and `margin` are unused
  uint32_t first_corner = kNoKeys;  ///< in BvhView::corner_keys; kNoKeys: the shape rests
  uint32_t first_triangle = 0;      ///< of the mesh's tree, for `first_corner`

  RELUME_HD bool is_timed() const { return first_key != kNoKeys || first_corner != kNoKeys; }
};

/// Columns of an instance's affine matrix at one key of the shutter.
struct BvhKey {
  Vec3 to_world[4];
};

// Flags of an instance.
inline constexpr uint32_t kNeedsOpacity = 1;
inline constexpr uint32_t kCullsBackFaces = 2;  ///< for camera rays
inline constexpr uint32_t kMirrored = 4;        ///< front faces appear clockwise

/// A BVH as traversals read it. Its arrays are in the memory of the host or of a device.
struct BvhView {
  View<const BvhNode> nodes;
  View<const BvhTriangle> triangles;
  View<const BvhInstance> instances;
  View<const uint32_t> filters;  ///< by instance of the scene: the flags above
  View<const BvhKey> keys;       ///< of the instances that move while the shutter is open, `key_count` each
  View<const Vec3> corner_keys;  ///< of their triangles that deform: three corners by key and triangle
  uint32_t key_count = 0;        ///< 0: nothing moves
  BvhChild root = BvhChild::none();
};

static_assert(std::is_trivially_copyable_v<BvhNode> && std::is_trivially_copyable_v<BvhTriangle> &&
              std::is_trivially_copyable_v<BvhInstance> && std::is_trivially_copyable_v<BvhKey> &&
              std::is_trivially_copyable_v<BvhView>);

}  // namespace relume
