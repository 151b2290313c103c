#include "scene/deforming_meshes.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/parallel.h"
#include "relume/error.h"
#include "scene/animation.h"
#include "scene/placement.h"

namespace relume {
namespace {

constexpr size_t kBoxVertices = 1024;  // of one task of deformed_box()

Affine affine_of(const Mat4& m) { return {Mat3(m), Vec3(m[3])}; }

std::vector<MorphTargetView> target_views(const Mesh& mesh) {
  std::vector<MorphTargetView> views;
  for (const MorphTarget& target : mesh.morph_targets)
    views.push_back({view_of(target.positions), view_of(target.normals), view_of(target.tangents), 0});
  return views;
}

DeformableMesh deformable(const Mesh& mesh, const std::vector<MorphTargetView>& targets, bool skinned,
                          const std::vector<Affine>& joints) {
  DeformableMesh v;
  v.positions = view_of(mesh.positions);
  v.normals = view_of(mesh.normals);
  v.tangents = view_of(mesh.tangents);
  v.targets = view_of(targets);
  v.influences = view_of(mesh.influences);
  v.influences_per_vertex = skinned ? static_cast<uint32_t>(mesh.influences_per_vertex) : 0;
  v.joints = view_of(joints);
  return v;
}

/// The inputs of deform() for a node's mesh at one time. `mesh` refers to the other members.
struct Pose {
  std::vector<MorphTargetView> targets;
  std::vector<Affine> joints;
  DeformableMesh mesh;
};

Pose pose_of(const Scene& scene, Index node_index, const Mesh& mesh, const JointMatrices& joints, float time_s) {
  const Node& node = scene.nodes[static_cast<size_t>(node_index)];
  const bool skinned = is_skinned(node, mesh);
  Pose pose{target_views(mesh), {}, {}};
  const std::vector<float> weights = morph_weights(scene, node_index, time_s);
  for (size_t k = 0; k < std::min(weights.size(), pose.targets.size()); ++k) pose.targets[k].weight = weights[k];
  if (skinned) {
    for (const Mat4& m : joints[static_cast<size_t>(node.skin)]) pose.joints.push_back(affine_of(m));
  }
  pose.mesh = deformable(mesh, pose.targets, skinned, pose.joints);
  return pose;
}

/// Range of a node's weight of each morph target over all times.
std::vector<ValueRange> weight_ranges(const Scene& scene, Index node, size_t targets) {
  std::vector<ValueRange> ranges(targets);
  const std::vector<float>& rest = scene.nodes[static_cast<size_t>(node)].morph_weights;
  for (size_t k = 0; k < std::min(targets, rest.size()); ++k) ranges[k] = {rest[k], rest[k]};
  for (const AnimationChannel& channel : scene.animation) {
    if (channel.property != AnimatedProperty::morph_weight || channel.node != node) continue;
    const auto target = static_cast<size_t>(channel.morph_target);
    if (target < targets) ranges[target] = value_range(channel);
  }
  return ranges;
}

/// Bounds of a vertex for all weights in `ranges`.
Box vertex_box(const Mesh& mesh, const std::vector<ValueRange>& ranges, size_t vertex) {
  Box box;
  box.add(mesh.positions[vertex]);
  for (size_t k = 0; k < ranges.size(); ++k) {
    if (mesh.morph_targets[k].positions.empty()) continue;
    const Vec3 at_low = ranges[k].low * mesh.morph_targets[k].positions[vertex];
    const Vec3 at_high = ranges[k].high * mesh.morph_targets[k].positions[vertex];
    box.low += glm::min(at_low, at_high);
    box.high += glm::max(at_low, at_high);
  }
  return box;
}

/// One box per joint, around the vertices that it influences. One box around all vertices for a mesh without skin.
std::vector<Box> joint_boxes(const Mesh& mesh, size_t joints, const std::vector<ValueRange>& ranges) {
  std::vector<Box> boxes(std::max<size_t>(joints, 1));
  const auto per_vertex = static_cast<size_t>(mesh.influences_per_vertex);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const Box box = vertex_box(mesh, ranges, v);
    if (joints == 0) boxes[0].add(box);
    for (size_t k = 0; joints > 0 && k < per_vertex; ++k) {
      const JointInfluence& influence = mesh.influences[v * per_vertex + k];
      if (influence.weight > 0) boxes[influence.joint].add(box);
    }
  }
  return boxes;
}

template <typename T>
size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

}  // namespace

bool is_deformable(const Node& node, const Mesh& mesh) { return !mesh.morph_targets.empty() || is_skinned(node, mesh); }

JointMatrices joint_matrices(const Scene& scene, std::span<const Mat4> world) {
  JointMatrices matrices;
  for (const Skin& skin : scene.skins) {
    std::vector<Mat4>& of_skin = matrices.emplace_back();
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      const glm::dmat4 to_world(world[static_cast<size_t>(skin.joints[j])]);
      of_skin.emplace_back(to_world * glm::dmat4(skin.inverse_bind[j]));
    }
  }
  return matrices;
}

void check_joints(const Scene& scene, const JointMatrices& joints) {
  for (size_t s = 0; s < joints.size(); ++s) {
    for (size_t j = 0; j < joints[s].size(); ++j) {
      if (within_reach(joints[s][j])) continue;
      const Node& joint = scene.nodes[static_cast<size_t>(scene.skins[s].joints[j])];
      throw Error(
          fmt::format("{}: joint '{}' is moved or scaled beyond {:g} m, or its matrix is not finite; correct the "
                      "transforms of the node and its ancestors",
                      error_place(scene), joint.name, kMaxCoordinate));
    }
  }
}

bool mirrors(const std::vector<Mat4>& joints) {
  const auto mirrored = std::count_if(joints.begin(), joints.end(), [](const Mat4& joint) {
    const Mat3 linear(joint);
    return glm::dot(linear[0], normal_matrix(linear)[0]) < 0;
  });
  return 2 * static_cast<size_t>(mirrored) > joints.size();
}

Mesh deformed_mesh(const Scene& scene, Index node_index, const Mesh& mesh, const JointMatrices& joints, float time_s) {
  const Node& node = scene.nodes[static_cast<size_t>(node_index)];
  const bool mirrored = is_skinned(node, mesh) && mirrors(joints[static_cast<size_t>(node.skin)]);
  const Pose pose = pose_of(scene, node_index, mesh, joints, time_s);

  Mesh result = mesh;
  result.morph_targets.clear();
  result.influences_per_vertex = 0;
  result.influences.clear();
  parallel_for(static_cast<uint32_t>(mesh.positions.size()), [&](uint32_t v) {
    const DeformedVertex vertex = deform(pose.mesh, v);
    result.positions[v] = vertex.position;
    if (!result.normals.empty()) result.normals[v] = vertex.normal;
    if (!result.tangents.empty())
      result.tangents[v] = Vec4(vertex.tangent, mesh.tangents[v].w * (mirrored ? -1.0f : 1.0f));
  });
  for (UVec3& t : result.triangles) {
    if (mirrored) std::swap(t.y, t.z);
  }
  return result;
}

Box deformed_box(const Scene& scene, Index node, const Mesh& mesh, const JointMatrices& joints, float time_s) {
  const Pose pose = pose_of(scene, node, mesh, joints, time_s);
  const size_t count = mesh.positions.size();
  std::vector<Box> parts((count + kBoxVertices - 1) / kBoxVertices);
  parallel_for(parts.size(), [&](size_t part) {
    const size_t end = std::min(count, (part + 1) * kBoxVertices);
    for (size_t v = part * kBoxVertices; v < end; ++v)
      parts[part].add(deform(pose.mesh, static_cast<uint32_t>(v)).position);
  });
  Box box;
  for (const Box& part : parts) box.add(part);
  return box;
}

DeformableMesh DeformingMeshes::Deforming::view() const { return deformable(*rest, targets, skin != kNone, joints); }

std::shared_ptr<const Mesh> DeformingMeshes::rest_pose(const Scene& scene, Index mesh) {
  for (const Deforming& known : meshes_) {
    if (known.source.mesh == mesh) return known.rest;
  }
  const Mesh& source = scene.meshes[static_cast<size_t>(mesh)];
  auto rest = std::make_shared<Mesh>();
  rest->positions = source.positions;
  rest->normals = source.normals;
  rest->tangents = source.tangents;
  rest->morph_targets = source.morph_targets;
  rest->influences_per_vertex = source.influences_per_vertex;
  rest->influences = source.influences;
  return rest;
}

uint32_t DeformingMeshes::add(const Scene& scene, const Source& source) {
  Deforming added;
  added.source = source;
  added.rest = rest_pose(scene, source.mesh);
  const Node& node = scene.nodes[static_cast<size_t>(source.node)];
  added.skin = is_skinned(node, *added.rest) ? node.skin : kNone;
  added.targets = target_views(*added.rest);
  const size_t joints = added.skin == kNone ? 0 : scene.skins[static_cast<size_t>(added.skin)].joints.size();
  added.joint_boxes =
      joint_boxes(*added.rest, joints, weight_ranges(scene, source.node, added.rest->morph_targets.size()));
  meshes_.push_back(std::move(added));
  return static_cast<uint32_t>(meshes_.size()) - 1;
}

void DeformingMeshes::keep(const std::vector<bool>& used) {
  for (size_t i = 0; i < meshes_.size(); ++i) meshes_[i].used = used[i];
}

Box DeformingMeshes::box(uint32_t number, const JointMatrices& joints) const {
  const Deforming& mesh = meshes_[number];
  if (mesh.skin == kNone) return mesh.joint_boxes[0];
  // A vertex lies in the convex hull of its positions under each of its joints alone.
  Box box;
  const std::vector<Mat4>& matrices = joints[static_cast<size_t>(mesh.skin)];
  for (size_t j = 0; j < matrices.size(); ++j) box.add(transformed(mesh.joint_boxes[j], matrices[j]));
  return box;
}

bool DeformingMeshes::update_pose(const Scene& scene, const JointMatrices& joints, float time_s, Deforming& mesh) {
  bool differs = !mesh.posed;
  mesh.posed = true;
  if (!mesh.targets.empty()) {
    const std::vector<float> weights = morph_weights(scene, mesh.source.node, time_s);
    for (size_t k = 0; k < std::min(weights.size(), mesh.targets.size()); ++k) {
      differs = differs || mesh.targets[k].weight != weights[k];
      mesh.targets[k].weight = weights[k];
    }
  }
  if (mesh.skin == kNone) return differs;
  const std::vector<Mat4>& matrices = joints[static_cast<size_t>(mesh.skin)];
  mesh.joints.resize(matrices.size());
  for (size_t j = 0; j < matrices.size(); ++j) {
    const Affine now = affine_of(matrices[j]);
    differs = differs || now.linear != mesh.joints[j].linear || now.translation != mesh.joints[j].translation;
    mesh.joints[j] = now;
  }
  return differs;
}

std::vector<uint32_t> DeformingMeshes::update(const Scene& scene, const JointMatrices& joints, float time_s,
                                              std::span<Vertex> vertices) {
  std::vector<uint32_t> moved;
  for (uint32_t number = 0; number < meshes_.size(); ++number) {
    if (meshes_[number].used && update_pose(scene, joints, time_s, meshes_[number])) moved.push_back(number);
  }
  parallel_tasks(moved.size(), [&](size_t i) {
    const Deforming& mesh = meshes_[moved[i]];
    const DeformVertices kernel{mesh.view(), {vertices.data() + mesh.source.first_vertex, mesh.source.vertex_count}};
    parallel_for(mesh.source.vertex_count, [&](uint32_t v) { kernel(v, 0); });
  });
  return moved;
}

size_t DeformingMeshes::memory_bytes() const {
  size_t sum = 0;
  std::vector<const Mesh*> counted;
  for (const Deforming& mesh : meshes_) {
    const Mesh& rest = *mesh.rest;
    if (std::find(counted.begin(), counted.end(), &rest) != counted.end()) continue;
    counted.push_back(&rest);
    sum += bytes_of(rest.positions) + bytes_of(rest.normals) + bytes_of(rest.tangents) + bytes_of(rest.influences);
    for (const MorphTarget& target : rest.morph_targets)
      sum += bytes_of(target.positions) + bytes_of(target.normals) + bytes_of(target.tangents);
  }
  return sum;
}

}  // namespace relume
