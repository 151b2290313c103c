#include "accel/bvh/build_tree.h"

#include <algorithm>
#include <cmath>

#include "accel/bvh/box_ray.h"
#include "accel/bvh/clip_triangle.h"
#include "accel/bvh/traverse.h"
#include "accel/embree/tree_builder.h"
#include "core/parallel.h"

namespace relume {
namespace {

using embree::BuildInner;
using embree::BuildLeaf;
using embree::BuildNode;

static_assert(embree::kBranches == kBvhWidth && embree::kMostPrimitives <= BvhChild::kMostTriangles);

Box box_of(const TriangleCorners& c) {
  Box box;
  for (const Vec3& p : {c.p0, c.p1, c.p2}) box.add(p);
  return box;
}

Box box_of(const RTCBounds& b) { return {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}}; }

RTCBuildPrimitive primitive_of(const Box& box, uint32_t geometry, uint32_t primitive) {
  return {box.low.x, box.low.y, box.low.z, geometry, box.high.x, box.high.y, box.high.z, primitive};
}

float largest_coordinate(const TriangleCorners& c) {
  return max_component(glm::max(abs(c.p0), glm::max(abs(c.p1), abs(c.p2))));
}

Box grown(const Box& box, float margin) { return {box.low - margin, box.high + margin}; }

void set_child(BvhNode& node, uint32_t i, const Box& box, BvhChild child) {
  for (int axis = 0; axis < 3; ++axis) {
    node.bounds[2 * axis][i] = box.low[axis];
    node.bounds[2 * axis + 1][i] = box.high[axis];
  }
  node.children[i] = child;
}

Box bounds_of(const BvhNode& node) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      box.low[axis] = std::min(box.low[axis], node.bounds[2 * axis][i]);
      box.high[axis] = std::max(box.high[axis], node.bounds[2 * axis + 1][i]);
    }
  }
  return box;
}

/// Writes the nodes of a built tree in depth-first order. `Leaf` returns the child and the box of a leaf.
template <typename Leaf>
class TreeWriter {
 public:
  TreeWriter(BvhTree& tree, const Leaf& leaf, uint32_t first_node = 0)
      : tree_(tree), leaf_(leaf), first_node_(first_node) {}

  /// At most kMeshDepth levels of recursion.
  Box write(const BuildNode& node, BvhChild& child) {
    if (node.is_leaf) return leaf_(static_cast<const BuildLeaf&>(node), child);
    const auto index = static_cast<uint32_t>(tree_.nodes.size());
    child = BvhChild::node(first_node_ + index);
    tree_.nodes.emplace_back();
    Box all;
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      Box box;
      BvhChild below = BvhChild::none();
      if (i < node.count) box = write(*static_cast<const BuildInner&>(node).children[i], below);
      set_child(tree_.nodes[index], i, box, below);
      all.add(box);
    }
    return all;
  }

 private:
  BvhTree& tree_;
  const Leaf& leaf_;
  uint32_t first_node_;
};

std::vector<RTCBuildPrimitive> list_primitives(std::span<const TreePart> parts) {
  std::vector<RTCBuildPrimitive> list;
  size_t count = 0;
  for (const TreePart& part : parts) count += part.mesh->triangle_count;
  list.reserve(count + count / 2);
  for (uint32_t part = 0; part < parts.size(); ++part) {
    const AccelMesh& mesh = *parts[part].mesh;
    for (uint32_t i = 0; i < mesh.triangle_count; ++i) {
      const TriangleCorners c = corners_of(mesh, i);
      if (std::isfinite(largest_coordinate(c))) list.push_back(primitive_of(box_of(c), part, i));
    }
  }
  return list;
}

void split(const RTCBuildPrimitive* primitive, unsigned axis, float position, RTCBounds* below, RTCBounds* above,
           void* context) {
  const auto& parts = *static_cast<const std::span<const TreePart>*>(context);
  const AccelMesh& mesh = *parts[embree::geometry_of(*primitive)].mesh;
  const float* corners[3];
  for (size_t k = 0; k < 3; ++k) {
    const size_t vertex = mesh.indices[size_t{3} * primitive->primID + k];
    corners[k] = reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(mesh.positions) +
                                                vertex * mesh.position_stride);
  }
  ClipBox within;
  within.low = bvh_detail::load(&primitive->lower_x);
  within.high = bvh_detail::load(&primitive->upper_x);
  const auto [low, high] = clip_triangle(corners, static_cast<int>(axis), position, within);
  bvh_detail::store(&below->lower_x, low.low);
  bvh_detail::store(&below->upper_x, low.high);
  bvh_detail::store(&above->lower_x, high.low);
  bvh_detail::store(&above->upper_x, high.high);
}

}  // namespace

Box box_with_margin(const BvhTriangle& triangle) {
  const TriangleCorners c{triangle.p0, triangle.p1, triangle.p2};
  return grown(box_of(c), kBoxMargin * largest_coordinate(c));
}

Box box_at_all_times(const AccelMesh& mesh, const BvhTriangle& triangle) {
  if (mesh.key_count == 0) return box_with_margin(triangle);
  Box box;
  float largest = 0;
  for (uint32_t k = 0; k < mesh.key_count; ++k) {
    const TriangleCorners c = corners_at_key(mesh, triangle.primitive, k);
    for (const Vec3& p : {c.p0, c.p1, c.p2}) box.add(p);
    largest = std::max(largest, largest_coordinate(c));
  }
  return grown(box, 2.0f * kBoxMargin * largest);
}

BvhTree build_tree(embree::Device& device, std::span<const TreePart> parts, bool deforms) {
  BvhTree tree;
  const auto list = [&] { return list_primitives(parts); };
  size_t count = 0;
  for (const TreePart& part : parts) count += part.mesh->triangle_count;
  const embree::BuiltTree built(device, list,
                                {.high_quality = !deforms,
                                 .max_primitives = embree::kMostPrimitives,
                                 .max_depth = kMeshDepth,
                                 .split = split,
                                 .split_context = &parts});
  if (!built.root()) return tree;
  tree.triangles.reserve(count);
  tree.nodes.reserve(count / 4);
  const auto write_leaf = [&](const BuildLeaf& leaf, BvhChild& child) {
    child = BvhChild::triangles(static_cast<uint32_t>(tree.triangles.size()), leaf.count);
    float margin = 0;
    for (uint32_t i = 0; i < leaf.count; ++i) {
      const TreePart& part = parts[leaf.primitives[i].geometry];
      const TriangleCorners c = corners_of(*part.mesh, leaf.primitives[i].primitive);
      margin = std::max(margin, kBoxMargin * largest_coordinate(c));
      tree.triangles.push_back({c.p0, leaf.primitives[i].primitive, c.p1, part.instance, c.p2, 0});
    }
    return grown(box_of(leaf.bounds), margin);
  };
  tree.bounds = TreeWriter(tree, write_leaf).write(*built.root(), tree.root);
  return tree;
}

BvhTree build_top_tree(embree::Device& device, std::span<const Box> boxes, std::span<const BvhChild> children,
                       uint32_t first_node) {
  BvhTree tree;
  const auto list = [&] {
    std::vector<RTCBuildPrimitive> primitives;
    for (uint32_t i = 0; i < boxes.size(); ++i) primitives.push_back(primitive_of(boxes[i], 0, i));
    return primitives;
  };
  const embree::BuiltTree built(device, list, {.max_primitives = 1, .max_depth = kTopDepth});
  const auto write_leaf = [&](const BuildLeaf& leaf, BvhChild& child) {
    child = children[leaf.primitives[0].primitive];
    return boxes[leaf.primitives[0].primitive];
  };
  tree.bounds = TreeWriter(tree, write_leaf, first_node).write(*built.root(), tree.root);
  return tree;
}

Box refit(const AccelMesh& mesh, std::span<BvhNode> nodes, std::span<BvhTriangle> triangles, uint32_t first_node,
          uint32_t first_triangle) {
  parallel_for(triangles.size(), [&](size_t i) {
    BvhTriangle& t = triangles[i];
    const TriangleCorners c = corners_of(mesh, t.primitive);
    t.p0 = c.p0;
    t.p1 = c.p1;
    t.p2 = c.p2;
  });
  parallel_for(nodes.size(), [&](size_t i) {
    for (uint32_t k = 0; k < kBvhWidth; ++k) {
      const BvhChild leaf = nodes[i].children[k];
      if (!leaf.is_triangles()) continue;
      Box box;
      for (uint32_t t = 0; t < leaf.count(); ++t)
        box.add(box_at_all_times(mesh, triangles[leaf.index() - first_triangle + t]));
      set_child(nodes[i], k, box, leaf);
    }
  });
  for (size_t i = nodes.size(); i-- > 0;) {  // children follow their parent
    for (uint32_t k = 0; k < kBvhWidth; ++k) {
      const BvhChild child = nodes[i].children[k];
      if (child.is_node()) set_child(nodes[i], k, bounds_of(nodes[child.node_index() - first_node]), child);
    }
  }
  if (!nodes.empty()) return bounds_of(nodes[0]);
  Box all;
  for (const BvhTriangle& triangle : triangles) all.add(box_at_all_times(mesh, triangle));
  return all;
}

BvhChild relocated(BvhChild child, uint32_t first_node, uint32_t first_triangle) {
  if (child.is_node()) return BvhChild::node(child.node_index() + first_node);
  if (child.is_triangles()) return BvhChild::triangles(child.index() + first_triangle, child.count());
  return child;
}

}  // namespace relume
