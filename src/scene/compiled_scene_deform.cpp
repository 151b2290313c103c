// Meshes deformed by skins and morph targets.
#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "scene/compiled_scene.h"

namespace relume {

bool CompiledScene::is_animated(const Node& node, Index node_index, const Mesh& mesh) const {
  const bool morphs = std::any_of(source_.animation.begin(), source_.animation.end(), [&](const AnimationChannel& c) {
    return c.property == AnimatedProperty::morph_weight && c.node == node_index;
  });
  if (morphs && !mesh.morph_targets.empty()) return true;
  if (!is_skinned(node, mesh)) return false;
  // A skinned mesh is in world space. Hiding it requires a separate acceleration structure.
  if (moves_[static_cast<size_t>(node_index)]) return true;
  const std::vector<Index>& joints = source_.skins[static_cast<size_t>(node.skin)].joints;
  return std::any_of(joints.begin(), joints.end(), [&](Index joint) { return moves_[static_cast<size_t>(joint)]; });
}

void CompiledScene::bake_static_deformations() {
  const JointMatrices joints = joint_matrices(source_, world_);
  check_joints(source_, joints);
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> baked;  // by node and mesh: the replacement mesh
  for (MeshInstance& placed : mesh_instances_) {
    const auto node_index = static_cast<Index>(placed.node);
    const Node& node = source_.nodes[placed.node];
    const Mesh& mesh = source_.meshes[placed.mesh];
    placed.skinned = is_skinned(node, mesh);
    placed.deforms = is_deformable(node, mesh) && is_animated(node, node_index, mesh);
    if (placed.deforms || !is_deformable(node, mesh)) continue;
    const auto [entry, is_new] =
        baked.try_emplace({placed.node, placed.mesh}, static_cast<uint32_t>(source_.meshes.size()));
    if (is_new) {
      Mesh result = deformed_mesh(source_, node_index, mesh, joints, time_s_);
      source_.meshes.push_back(std::move(result));
    }
    placed.mesh = entry->second;
  }
}

void CompiledScene::append_deforming_mesh(MeshInstance& placed) {
  const Index node = static_cast<Index>(placed.node);
  const Index mesh_index = static_cast<Index>(placed.mesh);
  for (uint32_t k = 0; k < deforming_.size(); ++k) {  // all instances of a node share its weights
    const DeformingMeshes::Source& known = deforming_.source(k);
    if (known.node != node || known.mesh != mesh_index) continue;
    placed.deforming = k;
    mesh_of_instance_.push_back(known.compiled_mesh);
    return;
  }
  const auto first_vertex = static_cast<uint32_t>(vertices_.size());
  const auto compiled_mesh = static_cast<uint32_t>(meshes_.size());
  append_mesh(placed.mesh, nullptr);
  const auto count = static_cast<uint32_t>(vertices_.size()) - first_vertex;
  placed.deforming = deforming_.add(source_, {node, mesh_index, compiled_mesh, first_vertex, count});
  MeshView& mesh = meshes_.write().back();
  mesh.deforms = true;
  mesh.first_previous = static_cast<uint32_t>(previous_positions_.size()) - first_vertex;
  previous_positions_.resize(previous_positions_.size() + count);
  std::vector<uint32_t> added(count);
  std::iota(added.begin(), added.end(), first_vertex);
  deforming_vertices_.append(added);
  mesh_of_instance_.push_back(compiled_mesh);
}

std::vector<uint32_t> CompiledScene::deform_meshes() {
  std::vector<uint32_t> deformed;
  if (deforming_.size() == 0) return deformed;
  const JointMatrices joints = joint_matrices(source_, world_);
  for (const uint32_t number : deforming_.update(source_, joints, time_s_, vertices_.mutable_view(), launcher_)) {
    deformed.push_back(deforming_.source(number).compiled_mesh);
  }
  if (deformed.empty()) return deformed;
  has_deformed_ = true;
  open_for_host();  // launches have ended the host's access
  return deformed;
}

void CompiledScene::keep_previous_positions() {
  if (!has_deformed_) return;
  // One launch of all meshes, also of those that did not deform: it cannot fail in part, so that no mesh loses its
  // previous positions.
  launcher_.run(
      StorePreviousPositionsKernel{vertices_.view(), deforming_vertices_.view(), previous_positions_.mutable_view()},
      static_cast<uint32_t>(previous_positions_.size()));
  has_deformed_ = false;
}

void CompiledScene::drop_removed_deformations() {
  std::vector<bool> used(deforming_.size(), false);
  for (const MeshInstance& placed : mesh_instances_) {
    if (placed.deforming != kNoHit) used[placed.deforming] = true;
  }
  deforming_.keep(used);
}

}  // namespace relume
