#include "accel/bvh/bvh_accel.h"

#include <algorithm>

#include <fmt/format.h>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/place_instance.h"
#include "accel/host_accel.h"
#include "accel/refit_cost.h"
#include "core/activity.h"
#include "core/parallel.h"
#include "relume/error.h"

namespace relume {
namespace {

/// A tree within the arrays of the BVH.
struct PlacedTree {
  uint32_t first_node = 0;
  uint32_t node_count = 0;
  uint32_t node_room = 0;  ///< capacity for nodes, which a rebuilt tree reuses
  uint32_t first_triangle = 0;
  uint32_t triangle_count = 0;
  uint32_t triangle_room = 0;
  BvhChild root = BvhChild::none();
  Box bounds;
};

}  // namespace

struct BvhAccel::State {
  explicit State(Memory& memory)
      : nodes(memory), triangles(memory), placed(memory), filters(memory), keys(memory), corner_keys(memory) {}

  embree::Device device;  ///< only for its builder
  std::vector<AccelMesh> meshes;
  std::vector<RefitCost> refit_costs;  ///< by mesh
  HostAccelData host;

  std::vector<PlacedTree> mesh_trees;  ///< by mesh; empty unless some instance needs it
  PlacedTree still;
  uint32_t lower_nodes = 0;  ///< number of nodes outside the top tree, whose nodes follow them

  Array<BvhNode> nodes;
  Array<BvhTriangle> triangles;
  Array<BvhInstance> placed;
  Array<uint32_t> filters;
  Array<BvhKey> keys;
  Array<Vec3> corner_keys;
  BvhView view;

  std::span<BvhNode> nodes_of(const PlacedTree& tree) {
    return nodes.write().subspan(tree.first_node, tree.node_count);
  }
  std::span<BvhTriangle> triangles_of(const PlacedTree& tree) {
    return triangles.write().subspan(tree.first_triangle, tree.triangle_count);
  }

  /// Copies a tree into the arrays: over its predecessor if there is room, or else to their ends.
  void place(const BvhTree& tree, PlacedTree& at) {
    const bool needs_room = tree.triangles.size() > at.triangle_room;
    if (needs_room && triangles.size() + tree.triangles.size() > BvhChild::kMostIndex) {
      throw Error(fmt::format(
          "the BVH would need room for {} triangles, including copies of split ones, and holds at most {}; use --accel "
          "embree or a smaller scene",
          triangles.size() + tree.triangles.size(), BvhChild::kMostIndex));
    }
    at.node_count = static_cast<uint32_t>(tree.nodes.size());
    if (at.node_count > at.node_room) {
      at.first_node = lower_nodes;
      at.node_room = std::max(at.node_count, at.node_room + at.node_room / 2);
      lower_nodes += at.node_room;
      nodes.resize(lower_nodes);  // update() writes the top tree again
    }
    at.triangle_count = static_cast<uint32_t>(tree.triangles.size());
    if (needs_room) {
      at.first_triangle = static_cast<uint32_t>(triangles.size());
      at.triangle_room = at.triangle_count;
      triangles.resize(triangles.size() + tree.triangles.size());
    }
    std::copy(tree.triangles.begin(), tree.triangles.end(), triangles_of(at).begin());
    const std::span<BvhNode> own = nodes_of(at);
    std::copy(tree.nodes.begin(), tree.nodes.end(), own.begin());
    for (BvhNode& node : own) {
      for (BvhChild& child : node.children) child = relocated(child, at.first_node, at.first_triangle);
    }
    at.root = relocated(tree.root, at.first_node, at.first_triangle);
    at.bounds = tree.bounds;
  }

  void build_mesh(uint32_t mesh) {
    const TreePart part{&meshes[mesh]};
    place(build_tree(device, {&part, 1}, meshes[mesh].deforms), mesh_trees[mesh]);
    if (meshes[mesh].key_count > 0 && !mesh_trees[mesh].root.is_none()) refit_mesh(mesh);  // to the boxes of all keys
  }

  void refit_mesh(uint32_t mesh) {
    PlacedTree& tree = mesh_trees[mesh];
    tree.bounds = refit(meshes[mesh], nodes_of(tree), triangles_of(tree), tree.first_node, tree.first_triangle);
  }

  /// Adapts the trees of meshes to their vertices.
  void follow(std::span<const uint32_t> deformed) {
    std::vector<uint8_t> has_grown(deformed.size(), 0);
    parallel_tasks(deformed.size(), [&](size_t i) {
      const uint32_t mesh = deformed[i];
      if (mesh_trees[mesh].root.is_none()) return;
      has_grown[i] = refit_costs[mesh].has_grown(meshes[mesh]);
      if (!has_grown[i]) refit_mesh(mesh);
    });
    for (size_t i = 0; i < deformed.size(); ++i) {
      if (!has_grown[i]) continue;
      build_mesh(deformed[i]);
      refit_costs[deformed[i]].reset(meshes[deformed[i]]);
    }
  }

  void set_instance_filters(std::span<const AccelInstance> instances) {
    filters.clear();
    for (const AccelInstance& instance : instances) {
      const AccelMesh& mesh = meshes[instance.mesh];
      const bool mirrored = mesh.deforms && instance.mirrored;
      filters.push_back((mesh.needs_opacity ? kNeedsOpacity : 0u) | (mesh.culls_back_faces ? kCullsBackFaces : 0u) |
                        (mirrored != mirrors(instance) ? kMirrored : 0u));
    }
  }

  /// Copies the corners of each mesh with keys. Returns their offsets by mesh.
  std::vector<uint32_t> copy_corner_keys() {
    std::vector<uint32_t> first(meshes.size(), kNoKeys);
    corner_keys.clear();
    for (uint32_t m = 0; m < meshes.size(); ++m) {
      const AccelMesh& mesh = meshes[m];
      if (mesh.key_count == 0 || mesh_trees[m].root.is_none()) continue;
      first[m] = static_cast<uint32_t>(corner_keys.size());
      view.key_count = mesh.key_count;
      const size_t count = size_t{3} * mesh.key_count;
      corner_keys.resize(first[m] + mesh_trees[m].triangle_count * count);
      Vec3* const corners = corner_keys.write().data() + first[m];
      const std::span<const BvhTriangle> own =
          triangles.read().subspan(mesh_trees[m].first_triangle, mesh_trees[m].triangle_count);
      parallel_for(own.size(), [&](size_t i) {
        for (uint32_t k = 0; k < mesh.key_count; ++k) {
          const TriangleCorners c = corners_at_key(mesh, own[i].primitive, k);
          const Vec3 in_order[] = {c.p0, c.p1, c.p2};
          std::copy(std::begin(in_order), std::end(in_order), corners + i * count + size_t{3} * k);
        }
      });
    }
    return first;
  }

  /// Adds the keys of an instance, and returns its bounds at all times.
  Box add_keys(const AccelInstance& instance, const Box& bounds, BvhInstance& node) {
    std::vector<BvhKey> own;
    for (uint32_t k = 0; k < instance.key_count; ++k) {
      own.push_back(bvh_key(instance.keys[k]));
      node.reach = std::max(node.reach, reach_at(own.back(), bounds));
    }
    node.first_key = static_cast<uint32_t>(keys.size());
    view.key_count = instance.key_count;
    keys.append(own);
    return swept_box(own, node.reach, bounds);
  }

  void build_top(std::span<const AccelInstance> instances) {
    placed.clear();
    keys.clear();
    view.key_count = 0;
    const std::vector<uint32_t> first_corners = copy_corner_keys();
    std::vector<Box> boxes;
    std::vector<BvhChild> children;
    if (!still.root.is_none()) {
      boxes.push_back(still.bounds);
      children.push_back(still.root);
    }
    for (uint32_t i = 0; i < instances.size(); ++i) {
      const AccelInstance& instance = instances[i];
      const PlacedTree& tree = mesh_trees[instance.mesh];
      if (!instance.visible || tree.root.is_none() || stands_still(instance, meshes[instance.mesh])) continue;
      std::optional<BvhInstance> node = place_instance(instance, i, tree.root, tree.bounds);
      if (!node) continue;
      node->first_corner = first_corners[instance.mesh];
      node->first_triangle = tree.first_triangle;
      boxes.push_back(instance.key_count > 0 ? add_keys(instance, tree.bounds, *node) : placed_box(*node, tree.bounds));
      children.push_back(BvhChild::instance(static_cast<uint32_t>(placed.size())));
      placed.push_back(*node);
    }
    nodes.resize(lower_nodes);
    view.root = children.empty() ? BvhChild::none() : children.front();
    if (children.size() > 1) {
      const BvhTree top = build_top_tree(device, boxes, children, lower_nodes);
      nodes.append(top.nodes);
      view.root = top.root;
    }
    view.nodes = nodes.view();
    view.triangles = triangles.view();
    view.instances = placed.view();
    view.filters = filters.view();
    view.keys = keys.view();
    view.corner_keys = corner_keys.view();
  }
};

BvhAccel::BvhAccel(std::span<const AccelMesh> meshes, std::span<const AccelInstance> instances, OpacityFunction opacity,
                   Memory& memory)
    : state_(std::make_unique<State>(memory)) {
  const Activity activity("building the acceleration structure");
  State& s = *state_;
  s.host.opacity = opacity;
  s.meshes.assign(meshes.begin(), meshes.end());
  for (const AccelMesh& mesh : s.meshes) s.refit_costs.emplace_back(mesh);
  s.mesh_trees.resize(meshes.size());
  std::vector<TreePart> still;
  std::vector<bool> needs_tree(meshes.size(), false);
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const AccelInstance& instance = instances[i];
    const AccelMesh& mesh = s.meshes[instance.mesh];
    if (!stands_still(instance, mesh)) {
      needs_tree[instance.mesh] = true;
    } else if (instance.visible) {
      still.push_back({&mesh, i});
    }
  }
  s.place(build_tree(s.device, still, false), s.still);
  for (uint32_t mesh = 0; mesh < meshes.size(); ++mesh) {
    if (needs_tree[mesh]) s.build_mesh(mesh);
  }
  s.nodes.reserve(s.nodes.size() + 2 * instances.size());  // the top tree's
  update(instances, {});
}

BvhAccel::~BvhAccel() = default;

void BvhAccel::set_keys(std::span<const AccelMeshKeys> keys) { assign_keys(state_->meshes, keys); }

void BvhAccel::update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed) {
  State& s = *state_;
  s.view.root = BvhChild::none();  // the arrays may move: if this fails, no ray may read them
  s.follow(deformed);
  s.set_instance_filters(instances);
  s.build_top(instances);
}

void BvhAccel::set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity,
                           bool culls_back_faces) {
  state_->meshes[mesh].needs_opacity = needs_opacity;
  state_->meshes[mesh].culls_back_faces = culls_back_faces;
  state_->set_instance_filters(instances);
  state_->view.filters = state_->filters.view();
}

AccelView BvhAccel::view() const { return {state_->view, {&state_->host}, AccelChoice::bvh}; }

void BvhAccel::open_for_host() const {
  state_->nodes.permit_reading();
  state_->triangles.permit_reading();
  state_->placed.permit_reading();
  state_->filters.permit_reading();
  state_->keys.permit_reading();
  state_->corner_keys.permit_reading();
}

size_t BvhAccel::memory_bytes() const {
  const State& s = *state_;
  return s.nodes.memory_bytes() + s.triangles.memory_bytes() + s.placed.memory_bytes() + s.filters.memory_bytes() +
         s.keys.memory_bytes() + s.corner_keys.memory_bytes() + s.refit_costs.capacity() * sizeof(RefitCost) +
         s.device.memory_bytes();
}

}  // namespace relume
