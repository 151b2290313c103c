#include "techniques/spatial/octree/octree_tree.h"

#include <algorithm>
#include <bit>

#include "core/stream_io.h"

namespace relume {
namespace {

/// Depth of each node. Children follow their parents, so one pass suffices.
std::vector<uint8_t> depths_of(std::span<const uint32_t> nodes) {
  std::vector<uint8_t> depths(nodes.size(), 0);
  for (uint32_t node = 0; node < nodes.size(); ++node) {
    for (uint32_t child = 0; child < 8; ++child) {
      if (!((nodes[node] >> child) & 1u)) depths[octree_inner_child(nodes[node], child)] = depths[node] + 1;
    }
  }
  return depths;
}

/// Whether `nodes` are a tree as rebuild() builds it, within kMaxOctreeDepth and kMaxOctreeNodes.
bool is_breadth_first(std::span<const uint32_t> nodes) {
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
std::vector<uint32_t> rebuild(std::span<const uint32_t> nodes, std::span<const uint8_t> split,
                              std::span<const uint8_t> collapse) {
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

OctreeTree::OctreeTree(const Vec3& center, float edge, Memory& memory)
    : corner_(center - 0.5f * edge),
      scale_(static_cast<float>(1u << kMaxOctreeDepth) / edge),
      nodes_(memory),
      links_(memory) {
  nodes_.assign(1, make_octree_node(0, 0xffu));
  links_.parents.reset(1);
  links_.neighbours.assign(48, kNoRegion);
  links_.previous.reset(8, kUninitialized);
  const std::span<uint32_t> neighbours = links_.neighbours.write();
  const std::span<uint32_t> previous = links_.previous.write();
  for (uint32_t slot = 0; slot < 8; ++slot) {
    previous[slot] = slot;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const bool high = (slot >> axis) & 1u;
      neighbours[6 * slot + 2 * axis + (high ? 0 : 1)] = slot ^ (1u << axis);
    }
  }
}

OctreeView OctreeTree::view() const { return {nodes_.view(), corner_, scale_}; }

OctreeCube OctreeTree::cube_of(uint32_t slot) const {
  const OctreeCell cell = octree_cell_of(view_of(nodes_.read()), view_of(links_.parents.read()), slot);
  return {corner_ + Vec3(cell.corner) / scale_, static_cast<float>(cell.size()) / scale_};
}

uint32_t OctreeTree::leaf_count() const {
  uint32_t count = 0;
  for (const uint32_t node : nodes_.read()) count += static_cast<uint32_t>(std::popcount(octree_leaf_mask(node)));
  return count;
}

std::vector<uint8_t> OctreeTree::leaf_depths() const {
  const std::vector<uint8_t> nodes = depths_of(nodes_.read());
  std::vector<uint8_t> depths(leaf_slots());
  for (uint32_t slot = 0; slot < leaf_slots(); ++slot) depths[slot] = static_cast<uint8_t>(nodes[slot / 8] + 1);
  return depths;
}

size_t OctreeTree::memory_bytes() const {
  return nodes_.memory_bytes() + links_.parents.memory_bytes() + links_.neighbours.memory_bytes() +
         links_.previous.memory_bytes();
}

void OctreeTree::save(std::ostream& out) const {
  write_value(out, corner_);
  write_value(out, scale_);
  write_array(out, nodes_);
}

void OctreeTree::load(std::istream& in) {
  read_value(in, corner_);
  read_value(in, scale_);
  read_array(in, nodes_);
  if (!is_breadth_first(nodes_.read()) || !is_finite(corner_) || !is_finite(scale_) || !(scale_ > 0)) {
    *this = OctreeTree(Vec3(0), 1.0f, nodes_.memory());
    return in.setstate(std::ios::failbit);
  }
  augment(*this, {}, [this](const auto& kernel, uint32_t count) {
    nodes_.read();  // on the host, which needs access to what the kernels access
    links_.parents.write();
    links_.neighbours.write();
    links_.previous.write();
    for (uint32_t i = 0; i < count; ++i) kernel(i, 0);
  });
  measure_depth();
}

OctreeTree OctreeTree::adapted(Backend& backend, View<const uint32_t> counts,
                               const OctreeThresholds& thresholds) const {
  Memory& memory = nodes_.memory();
  Array<uint8_t> depths(memory);
  backend.run("octree.mark", [&] { depths.assign(depths_of(nodes_.read())); });
  Array<uint8_t> split(memory);
  Array<uint8_t> collapse(memory);
  split.reset(nodes_.size());
  collapse.reset(nodes_.size());
  OctreeThresholds limits = thresholds;
  limits.max_depth = std::min(limits.max_depth, kMaxOctreeDepth);
  launch(backend, "octree.mark",
         OctreeMarkKernel{nodes_.view(), depths.view(), counts, limits, split.mutable_view(), collapse.mutable_view()},
         node_count(), 1);
  OctreeTree next(memory);
  next.corner_ = corner_;
  next.scale_ = scale_;
  backend.run("octree.rebuild", [&] { next.nodes_.assign(rebuild(nodes_.read(), split.read(), collapse.read())); });
  next.augment(*this, counts,
               [&](const auto& kernel, uint32_t count) { launch(backend, "octree.augment", kernel, count, 1); });
  backend.run("octree.augment", [&] { next.measure_depth(); });
  return next;
}

template <typename Run>
void OctreeTree::augment(const OctreeTree& previous, View<const uint32_t> counts, const Run& run) {
  links_.parents.reset(nodes_.size());
  links_.neighbours.reset(size_t{6} * leaf_slots(), kUninitialized);
  links_.previous.reset(leaf_slots(), kUninitialized);
  run(OctreeParentsKernel{nodes_.view(), links_.parents.mutable_view()}, node_count());
  run(OctreeLeafLinksKernel{view(), previous.view(), links_.parents.view(), counts, links_.neighbours.mutable_view(),
                            links_.previous.mutable_view()},
      leaf_slots());
}

void OctreeTree::measure_depth() {
  const std::vector<uint8_t> depths = depths_of(nodes_.read());
  depth_ = 1u + *std::max_element(depths.begin(), depths.end());
}

}  // namespace relume
