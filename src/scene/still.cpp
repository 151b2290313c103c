#include "scene/still.h"

#include <utility>

#include "scene/animated_parameters.h"
#include "scene/animation.h"
#include "scene/deforming_meshes.h"

namespace relume {
namespace {

/// Replaces the meshes that skins or morph targets deform. The world matrices are those of the nodes at `time_s`.
void pose_meshes(Scene& scene, const std::vector<bool>& visible, float time_s) {
  const JointMatrices joints = joint_matrices(scene, world_matrices(scene, time_s));
  check_joints(scene, joints);
  const auto count = static_cast<Index>(scene.nodes.size());
  for (Index i = 0; i < count; ++i) {
    const auto n = static_cast<size_t>(i);
    Node in_world;
    for (Index& mesh_index : scene.nodes[n].meshes) {
      const Mesh& mesh = scene.meshes[static_cast<size_t>(mesh_index)];
      if (!visible[n] || !is_deformable(scene.nodes[n], mesh)) continue;
      const bool skinned = is_skinned(scene.nodes[n], mesh);
      Mesh posed = deformed_mesh(scene, i, mesh, joints, time_s);
      scene.meshes.push_back(std::move(posed));
      mesh_index = static_cast<Index>(scene.meshes.size()) - 1;
      if (skinned) in_world.meshes.push_back(std::exchange(mesh_index, kNone));
    }
    std::erase(scene.nodes[n].meshes, kNone);
    if (in_world.meshes.empty()) continue;
    in_world.name = scene.nodes[n].name;
    scene.add_node(std::move(in_world));
  }
}

void forget_deformations(Scene& scene) {
  for (Node& node : scene.nodes) {
    node.skin = kNone;
    node.morph_weights.clear();
  }
  for (Mesh& mesh : scene.meshes) {
    mesh.morph_targets.clear();
    mesh.influences_per_vertex = 0;
    mesh.influences.clear();
  }
  scene.skins.clear();
}

void apply_channels(Scene& scene, float time_s) {
  for (const AnimationChannel& c : scene.animation) {
    Node& node = scene.nodes[static_cast<size_t>(c.node)];
    if (is_transform(c.property)) apply(c, time_s, node.transform);
    if (c.property == AnimatedProperty::visible) node.visible = evaluate(c, time_s).x != 0;
  }
  apply_parameters(scene, time_s);
  scene.animation.clear();
  scene.parameter_animation.clear();
  scene.clips.clear();
}

}  // namespace

Scene still_scene(Scene scene, float time_s) {
  select_animation(scene, "");
  pose_meshes(scene, visible_nodes(scene, time_s), time_s);
  forget_deformations(scene);
  apply_channels(scene, time_s);
  return scene;
}

}  // namespace relume
