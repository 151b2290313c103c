#include "techniques/spatial/octree/octree_tree.h"

#include <algorithm>
#include <bit>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/scan.h"

namespace relume {
namespace {

constexpr uint32_t kNodesPerTile = 64;

/// Whether `nodes` are a tree as OctreeRebuildKernel builds it, within kMaxOctreeDepth and kMaxOctreeNodes.
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

OctreeTree OctreeTree::copy(Backend& backend) const {
  OctreeTree result(nodes_.memory());
  result.corner_ = corner_;
  result.scale_ = scale_;
  result.depth_ = depth_;
  const auto copy_to = [&](const Array<uint32_t>& from, Array<uint32_t>& to) {
    relume::copy(backend, "octree.copy", from, to);
  };
  copy_to(nodes_, result.nodes_);
  copy_to(links_.parents, result.links_.parents);
  copy_to(links_.neighbours, result.links_.neighbours);
  copy_to(links_.previous, result.links_.previous);
  return result;
}

void OctreeTree::write_leaf_depths(Backend& backend, Array<uint8_t>& depths) const {
  depths.reset(leaf_slots(), kUninitialized);
  const OctreeLeafDepthsKernel kernel{{links_.parents.view()}, depths.mutable_view()};
  launch(backend, "octree.depths", kernel, leaf_slots(), 1, {}, kNodesPerTile);
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
    nodes_.read();  // opens the arrays, because the kernels run on the host here
    links_.parents.write();
    links_.neighbours.write();
    links_.previous.write();
    for (uint32_t i = 0; i < count; ++i) kernel(i, 0);
  });
  // The last node of a breadth-first tree is one of the deepest.
  depth_ = 1 + OctreeDepths{view_of(links_.parents.read())}(nodes_.size() - 1);
}

OctreeTree OctreeTree::adapted(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds,
                               OctreeScratch& scratch) const {
  OctreeTree next(nodes_.memory());
  next.corner_ = corner_;
  next.scale_ = scale_;
  mark(backend, counts, thresholds, scratch);
  rebuild(backend, scratch, next.nodes_);
  next.augment(*this, counts, [&](const auto& kernel, uint32_t count) {
    launch(backend, "octree.augment", kernel, count, 1, {}, kNodesPerTile);
  });
  const OctreeDepths depths{next.links_.parents.view()};
  next.depth_ = 1 + reduce<Max<uint32_t>>({backend, "octree.augment", scratch.primitives}, depths, next.node_count());
  return next;
}

void OctreeTree::mark(Backend& backend, View<const uint32_t> counts, const OctreeThresholds& thresholds,
                      OctreeScratch& scratch) const {
  const PrimitiveLaunch at{backend, "octree.mark", scratch.primitives};
  scratch.split.reset(nodes_.size(), kUninitialized);
  scratch.collapse.reset(nodes_.size(), kUninitialized);
  OctreeThresholds limits = thresholds;
  limits.max_depth = std::min(limits.max_depth, kMaxOctreeDepth);
  limits.max_nodes = std::min(limits.max_nodes, kMaxOctreeNodes);
  const OctreeMarkKernel kernel{nodes_.view(), {links_.parents.view()},      counts,
                                limits,        scratch.split.mutable_view(), scratch.collapse.mutable_view()};
  launch(backend, at.name, kernel, node_count(), 1, {}, kNodesPerTile);
  const uint32_t room = limits.max_nodes - std::min(limits.max_nodes, node_count());
  const OctreeSplits splits{scratch.split.view()};
  if (reduce<Sum<uint64_t>>(at, splits, node_count()) <= room) return;
  scratch.offsets.reset(nodes_.size(), kUninitialized);
  exclusive_scan(at, splits, scratch.offsets.mutable_view());
  const OctreeLimitSplitsKernel limit{scratch.offsets.view(), room, scratch.split.mutable_view()};
  launch(backend, at.name, limit, node_count(), 1, {}, kNodesPerTile);
}

void OctreeTree::rebuild(Backend& backend, OctreeScratch& scratch, Array<uint32_t>& next) const {
  const PrimitiveLaunch at{backend, "octree.rebuild", scratch.primitives};
  const OctreeChanges changes{nodes_.view(), scratch.split.view(), scratch.collapse.view()};
  scratch.offsets.reset(nodes_.size(), kUninitialized);
  const uint64_t inner = exclusive_scan(at, changes, scratch.offsets.mutable_view());
  next.reset(1 + inner, kUninitialized);
  const OctreeRebuildKernel kernel{changes, scratch.offsets.view(), next.mutable_view()};
  launch(backend, at.name, kernel, node_count(), 1, {}, kNodesPerTile);
}

template <typename Run>
void OctreeTree::augment(const OctreeTree& previous, View<const uint32_t> counts, const Run& run) {
  links_.parents.reset(nodes_.size(), kUninitialized);
  links_.neighbours.reset(size_t{6} * leaf_slots(), kUninitialized);
  links_.previous.reset(leaf_slots(), kUninitialized);
  run(OctreeParentsKernel{nodes_.view(), links_.parents.mutable_view()}, node_count());
  run(OctreeLeafLinksKernel{view(), previous.view(), links_.parents.view(), counts, links_.neighbours.mutable_view(),
                            links_.previous.mutable_view()},
      leaf_slots());
}

}  // namespace relume
