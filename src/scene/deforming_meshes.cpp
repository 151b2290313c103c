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

/// Appends the displacements of a morph target by `append(values)`, and adds their number to `count`. Returns their
/// offsets.
template <typename Append>
MorphTargetData place_target(const MorphTarget& target, size_t& count, const Append& append) {
  const auto place = [&](const std::vector<Vec3>& values) {
    if (values.empty()) return kNoDisplacements;
    const auto first = static_cast<uint32_t>(count);
    append(values);
    count += values.size();
    return first;
  };
  MorphTargetData data;
  data.positions = place(target.positions);
  data.normals = place(target.normals);
  data.tangents = place(target.tangents);
  return data;
}

/// The inputs of deform() for a node's mesh at one time, on the host. `mesh` refers to the other members.
struct Pose {
  std::vector<MorphTargetData> targets;  ///< those with a nonzero weight
  std::vector<Vec3> displacements;
  std::vector<Affine> joints;
  DeformableMesh mesh;
};

Pose pose_of(const Scene& scene, Index node_index, const Mesh& mesh, const JointMatrices& joints, float time_s) {
  const Node& node = scene.nodes[static_cast<size_t>(node_index)];
  Pose pose;
  const std::vector<float> weights = morph_weights(scene, node_index, time_s);
  size_t count = 0;
  for (size_t k = 0; k < std::min(weights.size(), mesh.morph_targets.size()); ++k) {
    if (weights[k] == 0.0f) continue;
    pose.targets.push_back(place_target(mesh.morph_targets[k], count, [&](const std::vector<Vec3>& values) {
      pose.displacements.insert(pose.displacements.end(), values.begin(), values.end());
    }));
    pose.targets.back().weight = weights[k];
  }
  DeformableMesh& v = pose.mesh;
  if (is_skinned(node, mesh)) {
    for (const Mat4& m : joints[static_cast<size_t>(node.skin)]) pose.joints.push_back(affine_of(m));
    v.influences_per_vertex = static_cast<uint32_t>(mesh.influences_per_vertex);
  }
  v.positions = view_of(mesh.positions);
  v.normals = view_of(mesh.normals);
  v.tangents = view_of(mesh.tangents);
  v.targets = view_of(pose.targets);
  v.displacements = view_of(pose.displacements);
  v.influences = view_of(mesh.influences);
  v.joints = view_of(pose.joints);
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

DeformingMeshes::RestPose::RestPose(const Mesh& mesh, Memory& memory)
    : positions(memory),
      normals(memory),
      tangents(memory),
      influences(memory),
      influences_per_vertex(static_cast<uint32_t>(mesh.influences_per_vertex)),
      displacements(memory) {
  positions.assign(mesh.positions);
  normals.assign(mesh.normals);
  tangents.assign(mesh.tangents);
  influences.assign(mesh.influences);
  size_t count = 0;
  for (const MorphTarget& target : mesh.morph_targets) {
    targets.push_back(
        place_target(target, count, [&](const std::vector<Vec3>& values) { displacements.append(values); }));
  }
  displacements.shrink_to_fit();
}

size_t DeformingMeshes::RestPose::memory_bytes() const {
  return positions.memory_bytes() + normals.memory_bytes() + tangents.memory_bytes() + influences.memory_bytes() +
         displacements.memory_bytes();
}

DeformableMesh DeformingMeshes::Deforming::view() const {
  return {.positions = rest->positions.view(),
          .normals = rest->normals.view(),
          .tangents = rest->tangents.view(),
          .targets = targets.view(),
          .displacements = rest->displacements.view(),
          .influences = rest->influences.view(),
          .influences_per_vertex = skin != kNone ? rest->influences_per_vertex : 0,
          .joints = joints.view()};
}

std::shared_ptr<const DeformingMeshes::RestPose> DeformingMeshes::rest_pose(const Scene& scene, Index mesh) {
  for (const Deforming& known : meshes_) {
    if (known.source.mesh == mesh) return known.rest;
  }
  return std::make_shared<RestPose>(scene.meshes[static_cast<size_t>(mesh)], *memory_);
}

uint32_t DeformingMeshes::add(const Scene& scene, const Source& source) {
  const Mesh& mesh = scene.meshes[static_cast<size_t>(source.mesh)];
  const Node& node = scene.nodes[static_cast<size_t>(source.node)];
  Deforming added(*memory_);
  added.source = source;
  added.rest = rest_pose(scene, source.mesh);
  added.skin = is_skinned(node, mesh) ? node.skin : kNone;
  added.targets.assign(added.rest->targets);
  const size_t joints = added.skin == kNone ? 0 : scene.skins[static_cast<size_t>(added.skin)].joints.size();
  added.joint_boxes = joint_boxes(mesh, joints, weight_ranges(scene, source.node, mesh.morph_targets.size()));
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
  mesh.posed = false;
  if (!mesh.targets.empty()) {
    const std::vector<float> weights = morph_weights(scene, mesh.source.node, time_s);
    const std::span<MorphTargetData> targets = mesh.targets.write();
    for (size_t k = 0; k < std::min(weights.size(), targets.size()); ++k) {
      differs = differs || targets[k].weight != weights[k];
      targets[k].weight = weights[k];
    }
  }
  if (mesh.skin == kNone) return differs;
  const std::vector<Mat4>& matrices = joints[static_cast<size_t>(mesh.skin)];
  mesh.joints.resize(matrices.size());
  const std::span<Affine> placed = mesh.joints.write();
  for (size_t j = 0; j < matrices.size(); ++j) {
    const Affine now = affine_of(matrices[j]);
    differs = differs || now.linear != placed[j].linear || now.translation != placed[j].translation;
    placed[j] = now;
  }
  return differs;
}

std::vector<uint32_t> DeformingMeshes::update(const Scene& scene, const JointMatrices& joints, float time_s,
                                              View<Vertex> vertices, SceneLauncher& launcher) {
  std::vector<uint32_t> moved;
  for (uint32_t number = 0; number < meshes_.size(); ++number) {
    Deforming& mesh = meshes_[number];
    if (!mesh.used) continue;
    if (update_pose(scene, joints, time_s, mesh)) {
      moved.push_back(number);
    } else {
      mesh.posed = true;
    }
  }
  for (const uint32_t number : moved) {
    const Deforming& mesh = meshes_[number];
    const uint32_t count = mesh.source.vertex_count;
    launcher.run(DeformVerticesKernel{mesh.view(), {vertices.data + mesh.source.first_vertex, count}}, count);
  }
  for (const uint32_t number : moved) meshes_[number].posed = true;
  return moved;
}

bool DeformingMeshes::pose_keys(uint32_t number, const Scene& scene, std::span<const ShutterPose> poses,
                                View<Vertex> vertices, SceneLauncher& launcher) {
  Deforming& mesh = meshes_[number];
  if (!mesh.used) return false;
  const uint32_t count = mesh.source.vertex_count;
  bool moves = false;
  for (size_t k = 0; k < poses.size(); ++k) {
    mesh.posed = true;  // compares with the previous key; until the end, it is false whenever this throws
    const bool differs = update_pose(scene, poses[k].joints, poses[k].time_s, mesh);
    moves = moves || (k > 0 && differs);
    launcher.run(DeformVerticesKernel{mesh.view(), {vertices.data + k * count, count}}, count);
  }
  const ShutterPose& middle = poses[poses.size() / 2];
  update_pose(scene, middle.joints, middle.time_s, mesh);
  mesh.posed = true;
  return moves;
}

size_t DeformingMeshes::memory_bytes() const {
  size_t sum = 0;
  std::vector<const RestPose*> counted;
  for (const Deforming& mesh : meshes_) {
    sum += mesh.targets.memory_bytes() + mesh.joints.memory_bytes();
    if (std::find(counted.begin(), counted.end(), mesh.rest.get()) != counted.end()) continue;
    counted.push_back(mesh.rest.get());
    sum += mesh.rest->memory_bytes();
  }
  return sum;
}

}  // namespace relume
