#include "scene_io/gltf/gltf_skins.h"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "scene/placement.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

/// Values of a displacement; empty if absent or of another size.
std::vector<Vec3> displacements(const Document& document, const std::map<std::string, int>& target,
                                const std::string& attribute, const Mesh& mesh, Warnings& warnings) {
  const auto entry = target.find(attribute);
  if (entry == target.end()) return {};
  const size_t count = accessor_count(document, entry->second);
  if (accessor_components(document, entry->second) == 3 && count == mesh.positions.size())
    return read_vec3(document, entry->second);
  warnings.add(fmt::format("mesh '{}': {} of a morph target ({} elements) does not fit its {} vertices and is ignored",
                           mesh.name, attribute, count, mesh.positions.size()));
  return {};
}

std::vector<float> to_floats(const std::vector<double>& values) {
  std::vector<float> result;
  for (const double value : values) result.push_back(to_float(value));
  return result;
}

/// Normalises a vertex's weights to sum 1; without weights, it follows its first joint. Joints of zero weight become
/// joint 0.
void normalize(JointInfluence* influences, int count) {
  float sum = 0;
  for (int k = 0; k < count; ++k) {
    if (!(influences[k].weight > 0 && is_finite(influences[k].weight))) influences[k].weight = 0;
    if (k > 0 && influences[k].weight == 0) influences[k].joint = 0;
    sum += influences[k].weight;
  }
  if (!(sum > 0 && is_finite(sum))) {
    for (int k = 0; k < count; ++k) influences[k].weight = k == 0 ? 1.0f : 0.0f;
    return;
  }
  for (int k = 0; k < count; ++k) influences[k].weight /= sum;
}

/// Converts a skin whose joints are all nodes of the scene; otherwise std::nullopt with a warning.
std::optional<Skin> convert_skin(Document& document, const std::vector<Index>& node_of, int index) {
  const tinygltf::Skin& source = document.model.skins[static_cast<size_t>(index)];
  Skin skin;
  skin.name = source.name.empty() ? fmt::format("skin {}", index) : source.name;
  const auto unusable = [&](const std::string& problem) {
    document.warnings.add(fmt::format("skin '{}' {}; meshes keep their rest pose", skin.name, problem));
    return std::nullopt;
  };
  for (const int joint : source.joints) {
    if (joint < 0 || static_cast<size_t>(joint) >= node_of.size())
      document.damaged(fmt::format("skin '{}' has the joint {}, which does not exist", skin.name, joint));
    skin.joints.push_back(node_of[static_cast<size_t>(joint)]);
    if (skin.joints.back() == kNone) return unusable(fmt::format("has the joint {} outside of the scene", joint));
  }
  if (skin.joints.empty()) return unusable("has no joints");
  if (source.inverseBindMatrices >= 0) skin.inverse_bind = read_mat4(document, source.inverseBindMatrices);
  if (skin.inverse_bind.empty()) skin.inverse_bind.assign(skin.joints.size(), Mat4(1));
  if (skin.inverse_bind.size() < skin.joints.size())
    document.damaged(fmt::format("skin '{}' has {} joints but {} inverse bind matrices", skin.name, skin.joints.size(),
                                 skin.inverse_bind.size()));
  skin.inverse_bind.resize(skin.joints.size());
  for (Mat4& m : skin.inverse_bind) {
    if (!within_reach(m))
      return unusable(fmt::format("has an inverse bind matrix that is not finite or beyond {:g} m", kMaxCoordinate));
    for (int c = 0; c < 4; ++c) m[c][3] = c == 3 ? 1.0f : 0.0f;  // exporters leave rounding errors here
  }
  return skin;
}

}  // namespace

size_t joint_sets(const PrimitiveReader& reader) {
  size_t count = 0;
  while (reader.components(fmt::format("JOINTS_{}", count)) > 0) ++count;
  return count;
}

void read_influences(const PrimitiveReader& reader, Mesh& mesh, Warnings& warnings) {
  const size_t count = mesh.positions.size();
  std::vector<std::vector<Vec4>> joints;
  std::vector<std::vector<Vec4>> weights;
  for (int set = 0;; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set);
    const std::string weights_name = fmt::format("WEIGHTS_{}", set);
    if (reader.components(joints_name) == 0) break;
    if (reader.components(joints_name) != 4 || reader.components(weights_name) != 4 ||
        reader.count(joints_name) != count || reader.count(weights_name) != count) {
      warnings.add(fmt::format("mesh '{}': {} and {} do not fit its {} vertices and are ignored", mesh.name,
                               joints_name, weights_name, count));
      break;
    }
    joints.push_back(reader.vec4(joints_name));
    weights.push_back(reader.vec4(weights_name));
  }
  const int per_vertex = 4 * static_cast<int>(joints.size());
  mesh.influences_per_vertex = per_vertex;
  mesh.influences.resize(count * static_cast<size_t>(per_vertex));
  for (size_t v = 0; v < count && per_vertex > 0; ++v) {
    JointInfluence* influences = &mesh.influences[v * static_cast<size_t>(per_vertex)];
    for (int k = 0; k < per_vertex; ++k) {
      const float joint = joints[static_cast<size_t>(k / 4)][v][k % 4];
      const bool exists = joint >= 0 && joint <= 65535;
      influences[k] = {exists ? static_cast<uint32_t>(joint) : 0u,
                       exists ? weights[static_cast<size_t>(k / 4)][v][k % 4] : 0.0f};
    }
    normalize(influences, per_vertex);
  }
}

void read_morph_targets(const Document& document, const tinygltf::Primitive& primitive, Mesh& mesh,
                        Warnings& warnings) {
  for (const auto& source : primitive.targets) {
    MorphTarget& target = mesh.morph_targets.emplace_back();
    target.positions = displacements(document, source, "POSITION", mesh, warnings);
    if (!mesh.normals.empty()) target.normals = displacements(document, source, "NORMAL", mesh, warnings);
    if (!mesh.tangents.empty()) target.tangents = displacements(document, source, "TANGENT", mesh, warnings);
  }
}

std::vector<std::string> morph_target_names(const tinygltf::Mesh& mesh) {
  std::vector<std::string> names;
  if (!mesh.extras.IsObject() || !mesh.extras.Has("targetNames")) return names;
  const tinygltf::Value& list = mesh.extras.Get("targetNames");
  for (size_t i = 0; list.IsArray() && i < list.ArrayLen(); ++i) {
    const tinygltf::Value& name = list.Get(static_cast<int>(i));
    names.push_back(name.IsString() ? name.Get<std::string>() : std::string());
  }
  return names;
}

std::vector<float> default_morph_weights(const tinygltf::Model& model, const tinygltf::Node& node) {
  if (node.mesh < 0 || static_cast<size_t>(node.mesh) >= model.meshes.size()) return {};
  return to_floats(node.weights.empty() ? model.meshes[static_cast<size_t>(node.mesh)].weights : node.weights);
}

void import_skins(Document& document, const std::vector<Index>& node_of, Scene& scene) {
  std::map<Index, Index> known;
  for (Node& node : scene.nodes) {
    if (node.skin == kNone) continue;
    if (node.skin < 0 || static_cast<size_t>(node.skin) >= document.model.skins.size())
      document.damaged(fmt::format("node '{}' refers to skin {}, which does not exist", node.name, node.skin));
    const auto [entry, is_new] = known.try_emplace(node.skin, kNone);
    if (is_new) {
      if (std::optional<Skin> skin = convert_skin(document, node_of, node.skin)) {
        entry->second = static_cast<Index>(scene.skins.size());
        scene.skins.push_back(std::move(*skin));
      }
    }
    node.skin = entry->second;
    if (node.skin != kNone && !node.instances.empty()) {
      document.warnings.add(
          fmt::format("node '{}' has a skin, so its instances would coincide; one is kept", node.name));
      node.instances.clear();
    }
  }
}

void drop_unusable_skins(Document& document, Scene& scene) {
  for (Node& node : scene.nodes) {
    if (node.skin == kNone) continue;
    const Skin& skin = scene.skins[static_cast<size_t>(node.skin)];
    const auto lacks_joint = [&](Index mesh) {
      const std::vector<JointInfluence>& influences = scene.meshes[static_cast<size_t>(mesh)].influences;
      return std::any_of(influences.begin(), influences.end(),
                         [&](const JointInfluence& influence) { return influence.joint >= skin.joints.size(); });
    };
    if (std::none_of(node.meshes.begin(), node.meshes.end(), lacks_joint)) continue;
    document.warnings.add(fmt::format("node '{}': its mesh follows joints that skin '{}' lacks; it keeps its rest pose",
                                      node.name, skin.name));
    node.skin = kNone;
  }
}

}  // namespace relume::gltf
