#include "accel/embree/tree_builder.h"

#include <algorithm>
#include <new>
#include <utility>

#include "core/box.h"

namespace relume::embree {
namespace {

/// Primitives per additional one that splits may create.
constexpr size_t kSplitRoom = 2;

void fill(BuildLeaf& leaf, const RTCBuildPrimitive* primitives, size_t count) {
  leaf.is_leaf = true;
  leaf.count = static_cast<unsigned>(count);
  leaf.bounds = {primitives[0].lower_x, primitives[0].lower_y, primitives[0].lower_z, 0,
                 primitives[0].upper_x, primitives[0].upper_y, primitives[0].upper_z, 0};
  for (size_t i = 0; i < count; ++i) {
    const RTCBuildPrimitive& p = primitives[i];
    leaf.primitives[i] = {geometry_of(p), p.primID};
    leaf.bounds.lower_x = std::min(leaf.bounds.lower_x, p.lower_x);
    leaf.bounds.lower_y = std::min(leaf.bounds.lower_y, p.lower_y);
    leaf.bounds.lower_z = std::min(leaf.bounds.lower_z, p.lower_z);
    leaf.bounds.upper_x = std::max(leaf.bounds.upper_x, p.upper_x);
    leaf.bounds.upper_y = std::max(leaf.bounds.upper_y, p.upper_y);
    leaf.bounds.upper_z = std::max(leaf.bounds.upper_z, p.upper_z);
  }
}

/// Memory of the tree. Throws std::bad_alloc, which Embree's builder catches and reports.
void* allocate(RTCThreadLocalAllocator allocator, size_t bytes) {
  void* const memory = rtcThreadLocalAlloc(allocator, bytes, 16);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void* create_inner(RTCThreadLocalAllocator allocator, unsigned count, void*) {
  auto* node = new (allocate(allocator, sizeof(BuildInner))) BuildInner;
  node->is_leaf = false;
  node->count = count;
  return static_cast<BuildNode*>(node);
}

void set_children(void* node, void** children, unsigned count, void*) {
  auto* inner = static_cast<BuildInner*>(static_cast<BuildNode*>(node));
  for (unsigned i = 0; i < count; ++i) inner->children[i] = static_cast<const BuildNode*>(children[i]);
}

void ignore_bounds(void*, const RTCBounds**, unsigned, void*) {}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count, void*) {
  auto* leaf = new (allocate(allocator, sizeof(BuildLeaf))) BuildLeaf;
  fill(*leaf, primitives, count);
  return static_cast<BuildNode*>(leaf);
}

/// Moves the lower half along the longest side of the centres' box to the front. Returns its end.
RTCBuildPrimitive* split_at_median(RTCBuildPrimitive* begin, RTCBuildPrimitive* end) {
  const auto center = [](const RTCBuildPrimitive& p) {
    return Vec3(p.lower_x, p.lower_y, p.lower_z) * 0.5f + Vec3(p.upper_x, p.upper_y, p.upper_z) * 0.5f;
  };
  Box box;
  for (const RTCBuildPrimitive* p = begin; p != end; ++p) box.add(center(*p));
  const Vec3 side = box.extent();
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : (side.y >= side.z ? 1 : 2);
  RTCBuildPrimitive* middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [&](const RTCBuildPrimitive& a, const RTCBuildPrimitive& b) {
    return center(a)[axis] < center(b)[axis];
  });
  return middle;
}

unsigned depth_of(const BuildNode& node) {
  if (node.is_leaf) return 0;
  const auto& inner = static_cast<const BuildInner&>(node);
  unsigned depth = 0;
  for (unsigned i = 0; i < inner.count; ++i) depth = std::max(depth, depth_of(*inner.children[i]));
  return depth + 1;
}

}  // namespace

BuiltTree::BuiltTree(Device& device, const std::function<Primitives()>& list_primitives, const BuildOptions& options)
    : bvh_(rtcNewBVH(device.get()), &rtcReleaseBVH) {
  Primitives primitives = list_primitives();
  if (primitives.empty()) return;
  root_ = build(std::move(primitives), options);
  device.check(RTC_ERROR_UNKNOWN);  // reported for trees that are too deep
  if (root_ && depth_of(*root_) <= options.max_depth) return;
  primitives = list_primitives();
  root_ = halve(primitives.data(), primitives.data() + primitives.size(), options.max_primitives);
}

const BuildNode* BuiltTree::build(Primitives primitives, const BuildOptions& options) {
  const bool splits = options.high_quality && options.split;
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.primitiveCount = primitives.size();
  if (splits) primitives.resize(primitives.size() + primitives.size() / kSplitRoom);
  arguments.primitives = primitives.data();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.buildQuality = options.high_quality ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = kBranches;
  arguments.maxDepth = options.max_depth;
  arguments.maxLeafSize = options.max_primitives;
  arguments.bvh = bvh_.get();
  arguments.createNode = create_inner;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = ignore_bounds;
  arguments.createLeaf = create_leaf;
  arguments.splitPrimitive = splits ? options.split : nullptr;
  arguments.userPtr = options.split_context;
  return static_cast<const BuildNode*>(rtcBuildBVH(&arguments));
}

const BuildNode* BuiltTree::halve(RTCBuildPrimitive* begin, RTCBuildPrimitive* end, unsigned max_primitives) {
  const auto count = static_cast<size_t>(end - begin);
  if (count <= max_primitives) {
    fill(leaves_.emplace_back(), begin, count);
    return &leaves_.back();
  }
  RTCBuildPrimitive* middle = split_at_median(begin, end);
  BuildInner& node = inners_.emplace_back();
  node.is_leaf = false;
  node.count = 0;
  for (const auto& [first, last] : {std::pair(begin, middle), std::pair(middle, end)}) {
    RTCBuildPrimitive* quarter = last - first > 1 ? split_at_median(first, last) : last;
    node.children[node.count++] = halve(first, quarter, max_primitives);
    if (quarter != last) node.children[node.count++] = halve(quarter, last, max_primitives);
  }
  return &node;
}

}  // namespace relume::embree
