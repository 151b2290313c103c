// Adding and removing parts of a compiled scene. Indices stay valid: a removed part leaves an empty slot.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene/compiled_scene.h"
#include "scene/placement.h"

namespace relume {
namespace {

template <typename T>
Index append(std::vector<T>& list, T value) {
  list.push_back(std::move(value));
  return static_cast<Index>(list.size()) - 1;
}

/// Throws Error unless `index` is kNone or a valid index among `count` parts of this kind ("mesh").
void check_reference(Index index, size_t count, const char* kind, const std::string& place) {
  if (index == kNone || (index >= 0 && static_cast<size_t>(index) < count)) return;
  throw Error(fmt::format("{}: {} {} does not exist; add it first", place, kind, index));
}

/// Validates a mesh within a minimal scene.
void validate(const Mesh& mesh, const std::string& place) {
  Scene scene;
  scene.meshes.push_back(mesh);
  scene.meshes.back().material = kNone;
  relume::validate(scene, place);
}

}  // namespace

Index CompiledScene::add_material(const Material& material) {
  validate(material, error_place(source_));
  for (const TextureRef* ref : texture_refs(material))
    check_reference(ref->texture, source_.textures.size(), "texture", error_place(source_));
  check_mixture(static_cast<Index>(source_.materials.size()), material);
  edited_ = true;  // even if this fails: arrays may have moved
  const std::span<MeshView> meshes = meshes_.write();
  const Index index = append(source_.materials, material);
  try {
    build_materials();
  } catch (...) {
    source_.materials.pop_back();
    throw;
  }
  // The default material, for meshes without one, follows the others.
  for (MeshView& mesh : meshes) mesh.material += mesh.material >= static_cast<uint32_t>(index) ? 1 : 0;
  return index;
}

Index CompiledScene::add_mesh(const Mesh& mesh) {
  validate(mesh, error_place(source_));
  if (!mesh.morph_targets.empty() || mesh.influences_per_vertex > 0) {
    throw Error(ErrorCode::not_supported,
                fmt::format("{}: mesh '{}' has morph targets or joints, which meshes added to a session cannot have; "
                            "remove them, or start a session with a scene that has the mesh",
                            error_place(source_), mesh.name));
  }
  check_reference(mesh.material, source_.materials.size(), "material", error_place(source_));
  edited_ = true;  // even if this fails: arrays may have moved
  const Index index = append(source_.meshes, mesh);
  const GeometrySize before = geometry_size();
  try {
    shared_meshes_.resize(source_.meshes.size(), kNoHit);
    shared_meshes_.back() = before.meshes;
    append_mesh(static_cast<uint32_t>(index), nullptr);
    boxes_.push_back(box_of(meshes_.read().back()));
    Mesh kept;  // without arrays, which the compiled copy replaces
    kept.name = mesh.name;
    kept.material = mesh.material;
    source_.meshes.back() = std::move(kept);
  } catch (...) {
    source_.meshes.pop_back();
    shared_meshes_.resize(source_.meshes.size());
    drop_geometry_beyond(before);
    throw;
  }
  return index;
}

CompiledScene::GeometrySize CompiledScene::geometry_size() const {
  const auto size = [](const auto& array) { return static_cast<uint32_t>(array.size()); };
  return {size(meshes_), size(vertices_), size(triangles_), size(uv1_), size(colors_)};
}

void CompiledScene::drop_geometry_beyond(const GeometrySize& size) {
  meshes_.resize(size.meshes, kUninitialized);
  boxes_.resize(size.meshes);
  vertices_.resize(size.vertices, kUninitialized);
  triangles_.resize(size.triangles, kUninitialized);
  uv1_.resize(size.uv1, kUninitialized);
  colors_.resize(size.colors, kUninitialized);
}

Index CompiledScene::add_light(const PunctualLight& light) {
  validate(light, error_place(source_));
  edited_ = true;
  return append(source_.lights, light);
}

Index CompiledScene::add_node(const Node& node) {
  check_reference(node.parent, source_.nodes.size(), "node", error_place(source_));
  check_reference(node.light, source_.lights.size(), "light", error_place(source_));
  check_reference(node.camera, source_.cameras.size(), "camera", error_place(source_));
  if (node.skin != kNone || !node.morph_weights.empty()) {
    throw Error(ErrorCode::not_supported,
                fmt::format("{}: node '{}' has a skin or morph weights, which nodes added to a session cannot have; "
                            "remove them, or start a session with a scene that has the node",
                            error_place(source_), node.name));
  }
  for (const Index mesh : node.meshes) {
    check_reference(mesh, source_.meshes.size(), "mesh", error_place(source_));
    if (mesh == kNone || shared_meshes_[static_cast<size_t>(mesh)] == kNoHit) {
      throw Error(
          fmt::format("{}: mesh {} has one static instance, so no other node can use it; add it as a separate mesh",
                      error_place(source_), mesh));
    }
  }
  const Index index = append(source_.nodes, node);
  try {
    std::vector<Mat4> world = world_matrices(source_, time_s_);
    check_placement(source_, world, error_place(source_));
    Box box;
    for_each_place(node, [&](Index mesh, const Mat4& to_node) {
      box.add(transformed(boxes_[shared_meshes_[static_cast<size_t>(mesh)]], world.back() * to_node));
    });
    check_extent(box);
    visible_ = visible_nodes(source_, time_s_);
    world_ = std::move(world);
  } catch (...) {
    source_.nodes.pop_back();
    throw;
  }
  moves_.push_back(true);
  for_each_place(node, [&](Index mesh, const Mat4& to_node) {
    MeshInstance& placed = mesh_instances_.emplace_back();
    placed.node = static_cast<uint32_t>(index);
    placed.mesh = static_cast<uint32_t>(mesh);
    placed.local = to_node;
    world_space_.push_back(false);
    mesh_of_instance_.push_back(shared_meshes_[static_cast<size_t>(mesh)]);
  });
  edited_ = true;
  return index;
}

void CompiledScene::check_joints_stay(const Node& node, const std::vector<bool>& gone) const {
  for (const Index joint : source_.skins[static_cast<size_t>(node.skin)].joints) {
    if (!gone[static_cast<size_t>(joint)]) continue;
    throw Error(fmt::format("{}: node '{}' is a joint of node '{}'; remove that first", error_place(source_),
                            source_.nodes[static_cast<size_t>(joint)].name, node.name));
  }
}

std::vector<Index> CompiledScene::remove_node(Index node) {
  std::vector<bool> gone(source_.nodes.size(), false);
  gone[static_cast<size_t>(node)] = true;
  for (bool more = true; more;) {
    more = false;
    for (size_t i = 0; i < gone.size(); ++i) {
      const Index parent = source_.nodes[i].parent;
      if (gone[i] || parent == kNone || !gone[static_cast<size_t>(parent)]) continue;
      gone[i] = more = true;
    }
  }
  for (size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i] && source_.nodes[i].skin != kNone) check_joints_stay(source_.nodes[i], gone);
  }
  size_t kept = 0;
  for (size_t i = 0; i < mesh_instances_.size(); ++i) {
    if (gone[mesh_instances_[i].node]) continue;
    mesh_instances_[kept] = mesh_instances_[i];
    world_space_[kept] = world_space_[i];
    mesh_of_instance_[kept++] = mesh_of_instance_[i];
  }
  mesh_instances_.resize(kept);
  world_space_.resize(kept);
  mesh_of_instance_.resize(kept);
  drop_removed_deformations();
  std::vector<Index> removed;
  for (size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) continue;
    removed.push_back(static_cast<Index>(i));
    if (static_cast<Index>(i) == camera_node_) {  // keep the view
      default_camera_ = world_[i];
      camera_node_ = kNone;
    }
    source_.nodes[i] = Node{.name = {}, .parent = kNone, .transform = {}, .matrix = {}, .meshes = {}, .instances = {}};
    std::erase_if(source_.animation, [&](const AnimationChannel& c) { return c.node == static_cast<Index>(i); });
  }
  world_ = world_matrices(source_, time_s_);
  visible_ = visible_nodes(source_, time_s_);
  edited_ = true;
  return removed;
}

void CompiledScene::remove_mesh(Index mesh) {
  for (const Node& node : source_.nodes) {
    if (std::find(node.meshes.begin(), node.meshes.end(), mesh) != node.meshes.end())
      throw Error(
          fmt::format("{}: mesh {} is part of node '{}'; remove that first", error_place(source_), mesh, node.name));
  }
  shared_meshes_[static_cast<size_t>(mesh)] = kNoHit;
}

void CompiledScene::remove_light(Index light) {
  for (const Node& node : source_.nodes) {
    if (node.light == light)
      throw Error(
          fmt::format("{}: light {} is part of node '{}'; remove that first", error_place(source_), light, node.name));
  }
}

Change CompiledScene::commit_edits() {
  if (!edited_) return Change::none;
  open_for_host();
  return updated([&] {
    instances_.clear();
    extent_.add(placed_box(world_));
    set_bounds();
    if (is_stale_) {
      place_everything();
    } else {
      place_instances();
      pose_shutter();
      build_accel();
      lights_.discard_texture_tables();
      collect_lights();
    }
    was_moved_ = true;
    edited_ = false;
    refresh_view();  // the rest, which needs the new structure
    return Change::any;
  });
}

}  // namespace relume
