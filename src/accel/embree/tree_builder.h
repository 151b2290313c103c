// Embree's builder of trees, for relume's own BVH.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "accel/embree/device.h"

namespace relume::embree {

inline constexpr unsigned kBranches = 4;
/// Maximum number of primitives per leaf.
inline constexpr unsigned kMostPrimitives = 3;

/// RTCBuildPrimitive::geomID without the upper five bits, where Embree counts splits.
inline unsigned geometry_of(const RTCBuildPrimitive& primitive) { return primitive.geomID & 0x07ffffffu; }

/// Node of a built tree.
struct BuildNode {
  bool is_leaf;
  unsigned count;  ///< of children or primitives
};
struct BuildInner : BuildNode {
  const BuildNode* children[kBranches];
};
struct BuildLeaf : BuildNode {
  struct Primitive {
    unsigned geometry;
    unsigned primitive;
  };
  Primitive primitives[kMostPrimitives];
  RTCBounds bounds;
};

struct BuildOptions {
  bool high_quality = false;    ///< slower to build; splits primitives if `split` is set
  unsigned max_primitives = 1;  ///< per leaf, at most kMostPrimitives
  unsigned max_depth = 1;       ///< inner nodes from the root to a leaf; only a balanced tree may exceed it
  RTCSplitPrimitiveFunction split = nullptr;  ///< clips a primitive's bounds by a plane
  void* split_context = nullptr;
};

/// A tree over bounding boxes, by the surface area heuristic ([MacDonald90]), with spatial splits ([Stich09]) on
/// request.
class BuiltTree {
 public:
  using Primitives = std::vector<RTCBuildPrimitive>;

  /// Builds on all cores. If the tree exceeds `options.max_depth`, calls `list_primitives` again and builds a balanced
  /// tree instead. Throws Error if memory is short.
  BuiltTree(Device& device, const std::function<Primitives()>& list_primitives, const BuildOptions& options);

  /// nullptr without primitives.
  const BuildNode* root() const { return root_; }

 private:
  const BuildNode* build(Primitives primitives, const BuildOptions& options);
  /// A tree of equal halves.
  const BuildNode* halve(RTCBuildPrimitive* begin, RTCBuildPrimitive* end, unsigned max_primitives);

  std::unique_ptr<RTCBVHTy, decltype(&rtcReleaseBVH)> bvh_;  ///< owns the nodes, except the following
  std::deque<BuildInner> inners_;
  std::deque<BuildLeaf> leaves_;
  const BuildNode* root_ = nullptr;
};

}  // namespace relume::embree
