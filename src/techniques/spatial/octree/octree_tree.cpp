#include "techniques/spatial/octree/octree_tree.h"

#include <algorithm>
#include <bit>

#include "core/stream_io.h"

namespace relume {
namespace {

/// Depth of each node. Children follow their parents, so one pass suffices.
std::vector<uint8_t> depths_of(const std::vector<uint32_t>& nodes) {
  std::vector<uint8_t> depths(nodes.size(), 0);
  for (uint32_t node = 0; node < nodes.size(); ++node) {
    for (uint32_t child = 0; child < 8; ++child) {
      if (!((nodes[node] >> child) & 1u)) depths[octree_inner_child(nodes[node], child)] = depths[node] + 1;
    }
  }
  return depths;
}

/// Whether `nodes` are a tree as rebuild() builds it, within kMaxOctreeDepth and kMaxOctreeNodes.
bool is_breadth_first(const std::vector<uint32_t>& nodes) {
  if (nodes.empty() || nodes.size() > kMaxOctreeNodes) return false;
  std::vector<uint8_t> depths(nodes.size(), 0);
  size_t next = 1;
  for (size_t node = 0; node < nodes.size(); ++node) {
    const auto inner = static_cast<size_t>(8 - std::popcount(octree_leaf_mask(nodes[node])));
    if (node > 0 && node >= next) return false;
    if (octree_first_child(nodes[node]) != (inner > 0 ? next : 0) || next + inner > nodes.size()) return false;
    if (depths[node] + 1u >= kMaxOctreeDepth && inner > 0) return false;
    for (size_t child = 0; child < inner; ++child) depths[next + child] = depths[node] + 1;
    next += inner;
  }
  return next == nodes.size();
}

/// Builds the new nodes breadth-first. Leaves are only split while the tree has at most kMaxOctreeNodes nodes, the
/// range of child numbers.
std::vector<uint32_t> rebuild(const std::vector<uint32_t>& nodes, const std::vector<uint8_t>& split,
                              const std::vector<uint8_t>& collapse) {
  std::vector<uint32_t> result;
  size_t room = kMaxOctreeNodes - nodes.size();  // for inner nodes
  std::vector<uint32_t> queue{0};                // inner nodes of the new tree: number in the old one, or kNoRegion
  for (size_t i = 0; i < queue.size(); ++i) {
    const uint32_t old = queue[i];
    const uint32_t first = static_cast<uint32_t>(queue.size());
    uint32_t mask = 0;
    for (uint32_t child = 0; child < 8; ++child) {
      uint32_t origin = kNoRegion;
      bool leaf = true;
      if (old != kNoRegion && ((nodes[old] >> child) & 1u)) {
        leaf = !((split[old] >> child) & 1u) || room == 0;
        if (!leaf) --room;
      } else if (old != kNoRegion) {
        origin = octree_inner_child(nodes[old], child);
        leaf = collapse[origin] != 0;
      }
      if (leaf) {
        mask |= 1u << child;
      } else {
        queue.push_back(origin);
      }
    }
    result.push_back(make_octree_node(mask == 0xffu ? 0u : first, mask));
  }
  return result;
}

}  // namespace

OctreeTree::OctreeTree(const Vec3& center, float edge)
    : corner_(center - 0.5f * edge),
      scale_(static_cast<float>(1u << kMaxOctreeDepth) / edge),
      nodes_{make_octree_node(0, 0xffu)} {
  links_.parents = {0};
  links_.neighbours.resize(48, kNoRegion);
  for (uint32_t slot = 0; slot < 8; ++slot) {
    links_.previous.push_back(slot);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const bool high = (slot >> axis) & 1u;
      links_.neighbours[6 * slot + 2 * axis + (high ? 0 : 1)] = slot ^ (1u << axis);
    }
  }
}

OctreeView OctreeTree::view() const { return {view_of(nodes_), corner_, scale_}; }

OctreeCube OctreeTree::cube_of(uint32_t slot) const {
  const OctreeCell cell = octree_cell_of(view_of(nodes_), view_of(links_.parents), slot);
  return {corner_ + Vec3(cell.corner) / scale_, static_cast<float>(cell.size()) / scale_};
}

uint32_t OctreeTree::leaf_count() const {
  uint32_t count = 0;
  for (const uint32_t node : nodes_) count += static_cast<uint32_t>(std::popcount(octree_leaf_mask(node)));
  return count;
}

std::vector<uint8_t> OctreeTree::leaf_depths() const {
  const std::vector<uint8_t> nodes = depths_of(nodes_);
  std::vector<uint8_t> depths(leaf_slots());
  for (uint32_t slot = 0; slot < leaf_slots(); ++slot) depths[slot] = static_cast<uint8_t>(nodes[slot / 8] + 1);
  return depths;
}

size_t OctreeTree::memory_bytes() const {
  return sizeof(uint32_t) * (nodes_.size() + links_.parents.size() + links_.neighbours.size() + links_.previous.size());
}

void OctreeTree::save(std::ostream& out) const {
  write_value(out, corner_);
  write_value(out, scale_);
  write_vector(out, nodes_);
}

void OctreeTree::load(std::istream& in) {
  read_value(in, corner_);
  read_value(in, scale_);
  read_vector(in, nodes_);
  if (!is_breadth_first(nodes_) || !is_finite(corner_) || !is_finite(scale_) || !(scale_ > 0)) {
    *this = OctreeTree(Vec3(0), 1.0f);
    return in.setstate(std::ios::failbit);
  }
  Backend backend(1);
  augment(backend, *this, {});
}

OctreeTree OctreeTree::adapted(Backend& backend, View<const uint32_t> counts,
                               const OctreeThresholds& thresholds) const {
  std::vector<uint8_t> depths;
  backend.run("octree.mark", [&] { depths = depths_of(nodes_); });
  std::vector<uint8_t> split(nodes_.size());
  std::vector<uint8_t> collapse(nodes_.size());
  OctreeThresholds limits = thresholds;
  limits.max_depth = std::min(limits.max_depth, kMaxOctreeDepth);
  launch(backend, "octree.mark",
         OctreeMarkKernel{view_of(nodes_), view_of(depths), counts, limits, mutable_view_of(split),
                          mutable_view_of(collapse)},
         node_count(), 1);
  OctreeTree next;
  next.corner_ = corner_;
  next.scale_ = scale_;
  backend.run("octree.rebuild", [&] { next.nodes_ = rebuild(nodes_, split, collapse); });
  next.augment(backend, *this, counts);
  return next;
}

void OctreeTree::augment(Backend& backend, const OctreeTree& previous, View<const uint32_t> counts) {
  links_.parents.assign(nodes_.size(), 0);
  links_.neighbours.resize(size_t{6} * leaf_slots());
  links_.previous.resize(leaf_slots());
  launch(backend, "octree.augment", OctreeParentsKernel{view_of(nodes_), mutable_view_of(links_.parents)}, node_count(),
         1);
  launch(backend, "octree.augment",
         OctreeLeafLinksKernel{view(), previous.view(), view_of(links_.parents), counts,
                               mutable_view_of(links_.neighbours), mutable_view_of(links_.previous)},
         leaf_slots(), 1);
  backend.run("octree.augment", [&] {
    const std::vector<uint8_t> depths = depths_of(nodes_);
    depth_ = 1u + *std::max_element(depths.begin(), depths.end());
  });
}

}  // namespace relume
