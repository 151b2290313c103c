#include "scene_io/gltf/gltf_write_nodes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "relume/error.h"
#include "scene/animation.h"
#include "scene/light_parameters.h"

namespace relume::gltf {
namespace {

std::vector<Vec4> xyzw(const std::vector<Transform>& transforms) {
  std::vector<Vec4> values;
  for (const Transform& t : transforms) values.emplace_back(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w);
  return values;
}

/// Translation, rotation and scale that reproduce `matrix` within rounding; nothing for shear or zero scale.
std::optional<Transform> split(const Mat4& matrix) {
  const Mat3 linear(matrix);
  Transform t;
  t.translation = Vec3(matrix[3]);
  t.scale = {glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])};
  if (!(min_component(t.scale) > 0)) return std::nullopt;
  if (glm::determinant(linear) < 0) t.scale.x = -t.scale.x;
  t.rotation =
      glm::normalize(glm::quat_cast(Mat3(linear[0] / t.scale.x, linear[1] / t.scale.y, linear[2] / t.scale.z)));
  const Mat3 again = glm::mat3_cast(t.rotation);
  for (int c = 0; c < 3; ++c) {
    const float size = std::fabs(t.scale[c]);
    if (glm::length(again[c] * t.scale[c] - linear[c]) > 1e-5f * size) return std::nullopt;
  }
  return t;
}

OutputJson matrix_numbers(const Mat4& matrix) { return numbers(std::span(&matrix[0][0], 16)); }

/// Names of morph targets; null if none has a name.
OutputJson target_names(const Mesh& mesh) {
  OutputJson names;
  bool any = false;
  for (const MorphTarget& target : mesh.morph_targets) {
    names.push_back(target.name);
    any = any || !target.name.empty();
  }
  return any ? names : OutputJson();
}

}  // namespace

std::vector<int> NodeWriter::write() {
  write_cameras();
  write_lights();
  write_variants();
  std::vector<bool> animated(scene_.nodes.size(), false);
  hides_.assign(scene_.nodes.size(), false);
  for (const AnimationChannel& channel : scene_.animation) {
    if (is_transform(channel.property)) animated[static_cast<size_t>(channel.node)] = true;
    if (channel.property == AnimatedProperty::visible) hides_[static_cast<size_t>(channel.node)] = true;
  }
  std::vector<OutputJson> nodes;
  for (size_t i = 0; i < scene_.nodes.size(); ++i) nodes.push_back(node(i, animated[i]));
  std::vector<Index> parents;
  for (const Node& n : scene_.nodes) parents.push_back(n.parent);
  for (auto& [parent, extra] : extra_nodes_) {
    parents.push_back(parent);
    nodes.push_back(std::move(extra));
  }
  std::vector<int> roots;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (parents[i] == kNone) {
      roots.push_back(static_cast<int>(i));
    } else {
      nodes[static_cast<size_t>(parents[i])]["children"].push_back(i);
    }
  }
  for (OutputJson& json : nodes) output_.add("nodes", std::move(json));
  write_skins();
  return roots;
}

void NodeWriter::write_cameras() {
  for (const Camera& camera : scene_.cameras) {
    OutputJson json = OutputJson::object();
    if (!camera.name.empty()) json["name"] = camera.name;
    if (camera.projection == Projection::orthographic) {
      const float aspect_ratio = camera.aspect_ratio > 0 ? camera.aspect_ratio : 16.0f / 9.0f;
      const OutputJson width = number(camera.half_height * aspect_ratio);
      json["type"] = "orthographic";
      json["orthographic"] = {{"xmag", width}, {"ymag", number(camera.half_height)}, {"znear", 0}, {"zfar", 1e6}};
    } else {
      json["type"] = "perspective";
      json["perspective"] = {{"yfov", number(camera.fov_y_rad)}, {"znear", 0.01}};
      if (camera.aspect_ratio > 0) json["perspective"]["aspectRatio"] = number(camera.aspect_ratio);
    }
    OutputJson extras;
    if (camera.projection == Projection::panoramic) extras["projection"] = "panoramic";
    if (camera.lens_radius > 0) {
      extras["lens_radius"] = number(camera.lens_radius);
      extras["focus_distance"] = number(camera.focus_distance);
    }
    if (!extras.is_null()) json["extras"]["relume"] = std::move(extras);
    output_.add("cameras", std::move(json));
  }
}

void NodeWriter::write_lights() {
  if (scene_.lights.empty()) return;
  OutputJson lights = OutputJson::array();
  for (const PunctualLight& light : scene_.lights) {
    OutputJson json = OutputJson::object();
    if (!light.name.empty()) json["name"] = light.name;
    json["type"] = type_of(light).name;
    const float intensity = max_component(light.intensity);
    if (intensity > 0) json["color"] = numbers(light.intensity / intensity);
    json["intensity"] = number(intensity);
    for (const LightParameter& p : light_parameters()) {
      if (p.type != light.type) continue;
      const float value = light.*p.member;
      if (p.gltf_key) {
        json[std::string(type_of(light).name)][p.gltf_key] = number(value);
      } else if (value > 0) {
        json["extras"]["relume"][p.key] = number(glm::degrees(value));
      }
    }
    lights.push_back(std::move(json));
  }
  output_.root["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lights);
  output_.use_extension("KHR_lights_punctual");
}

OutputJson NodeWriter::node(size_t index, bool animated) {
  const Node& n = scene_.nodes[index];
  OutputJson json = OutputJson::object();
  if (!n.name.empty()) json["name"] = n.name;
  add_transform(json, n, animated);
  add_meshes(json, n);
  if (n.camera != kNone) json["camera"] = n.camera;
  if (n.skin != kNone && json.contains("mesh")) json["skin"] = n.skin;
  if (json.contains("mesh")) add_morph_weights(json, n);
  if (!n.visible || hides_[index]) {
    json["extensions"]["KHR_node_visibility"] = {{"visible", n.visible}};
    output_.use_extension("KHR_node_visibility");
  }
  if (n.light != kNone) json["extensions"]["KHR_lights_punctual"] = {{"light", n.light}};
  return json;
}

void NodeWriter::add_transform(OutputJson& json, const Node& n, bool animated) {
  if (n.matrix && !animated) {
    json["matrix"] = matrix_numbers(*n.matrix);
    return;
  }
  const Transform& t = n.transform;
  if (t.translation != Vec3(0)) json["translation"] = numbers(t.translation);
  const Vec4 q(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w);
  if (q != Vec4(0, 0, 0, 1)) json["rotation"] = numbers(std::span(&q.x, 4));
  if (t.scale != Vec3(1)) json["scale"] = numbers(t.scale);
}

void NodeWriter::add_meshes(OutputJson& json, const Node& n) {
  std::vector<Index> parts;
  for (const Index i : n.meshes) {
    if (!scene_.meshes[static_cast<size_t>(i)].triangles.empty()) parts.push_back(i);  // glTF has no empty accessors
  }
  if (parts.empty()) return;
  const int written = mesh(parts, n.name);
  std::vector<Transform> instances;
  for (const Mat4& matrix : n.instances) {
    const std::optional<Transform> t = split(matrix);
    if (!t) break;
    instances.push_back(*t);
  }
  if (instances.size() == n.instances.size()) {
    json["mesh"] = written;
    if (!instances.empty()) add_instances(json, instances);
    return;
  }
  const auto self = static_cast<Index>(&n - scene_.nodes.data());
  for (const Mat4& matrix : n.instances) {
    OutputJson extra = {{"mesh", written}, {"matrix", matrix_numbers(matrix)}};
    add_morph_weights(extra, n);
    extra_nodes_.push_back({self, std::move(extra)});
  }
  output_.warn(fmt::format("node '{}': its instances are sheared or flat, so each becomes a node", n.name));
}

int NodeWriter::mesh(const std::vector<Index>& parts, const std::string& name) {
  const auto [entry, is_new] = meshes_.try_emplace(parts, 0);
  if (!is_new) return entry->second;
  OutputJson json = OutputJson::object();
  const std::string& first = scene_.meshes[static_cast<size_t>(parts.front())].name;
  const std::string& chosen = parts.size() == 1 || name.empty() ? first : name;
  if (!chosen.empty()) json["name"] = chosen;
  json["primitives"] = OutputJson::array();
  if (const OutputJson names = target_names(scene_.meshes[static_cast<size_t>(parts.front())]); !names.is_null())
    json["extras"]["targetNames"] = names;
  for (const Index i : parts) {
    const auto [known, first_use] = primitives_.try_emplace(i);
    if (first_use) known->second = primitive(scene_.meshes[static_cast<size_t>(i)]);
    json["primitives"].push_back(known->second);
    // All primitives of a mesh need the same number of targets.
    const auto vertices = scene_.meshes[static_cast<size_t>(i)].positions.size();
    for (size_t k = scene_.meshes[static_cast<size_t>(i)].morph_targets.size(); k < target_count(parts); ++k)
      json["primitives"].back()["targets"].push_back({{"POSITION", no_displacements(vertices)}});
  }
  entry->second = output_.add("meshes", std::move(json));
  return entry->second;
}

OutputJson NodeWriter::primitive(const Mesh& m) {
  const auto target = BufferTarget::vertices;
  OutputJson attributes = {{"POSITION", output_.add_floats(flat<3>(m.positions), 3, target, true)}};
  if (!m.normals.empty()) attributes["NORMAL"] = output_.add_floats(flat<3>(m.normals), 3, target);
  if (!m.tangents.empty()) attributes["TANGENT"] = output_.add_floats(flat<4>(m.tangents), 4, target);
  if (!m.uv0.empty()) attributes["TEXCOORD_0"] = output_.add_floats(flat<2>(m.uv0), 2, target);
  if (!m.uv1.empty()) attributes["TEXCOORD_1"] = output_.add_floats(flat<2>(m.uv1), 2, target);
  if (!m.colors.empty()) attributes["COLOR_0"] = output_.add_floats(flat<4>(m.colors), 4, target);
  add_influences(attributes, m);
  OutputJson json = {{"attributes", std::move(attributes)},
                     {"indices", output_.add_indices(m.triangles, m.positions.size())}};
  add_morph_targets(json, m);
  const Index material = m.default_material.value_or(m.material);
  if (material != kNone) json["material"] = material;
  if (!m.variants.empty()) {
    OutputJson mappings = OutputJson::array();
    for (const VariantMaterial& choice : m.variants)
      mappings.push_back({{"material", choice.material}, {"variants", {choice.variant}}});
    json["extensions"]["KHR_materials_variants"]["mappings"] = std::move(mappings);
  }
  return json;
}

void NodeWriter::write_variants() {
  if (scene_.variants.empty()) return;
  OutputJson variants = OutputJson::array();
  for (const std::string& name : scene_.variants) variants.push_back({{"name", name}});
  output_.root["extensions"]["KHR_materials_variants"]["variants"] = std::move(variants);
  output_.use_extension("KHR_materials_variants");
}

void NodeWriter::add_instances(OutputJson& json, const std::vector<Transform>& instances) {
  std::vector<Vec3> translations;
  std::vector<Vec3> scales;
  for (const Transform& t : instances) {
    translations.push_back(t.translation);
    scales.push_back(t.scale);
  }
  json["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", output_.add_floats(flat<3>(translations), 3, BufferTarget::none)},
      {"ROTATION", output_.add_floats(flat<4>(xyzw(instances)), 4, BufferTarget::none)},
      {"SCALE", output_.add_floats(flat<3>(scales), 3, BufferTarget::none)}};
  output_.use_extension("EXT_mesh_gpu_instancing", true);
}

size_t NodeWriter::target_count(std::span<const Index> meshes) const {
  size_t most = 0;
  for (const Index mesh : meshes) most = std::max(most, scene_.meshes[static_cast<size_t>(mesh)].morph_targets.size());
  return most;
}

void NodeWriter::add_morph_weights(OutputJson& json, const Node& n) {
  std::vector<float> weights = n.morph_weights;
  weights.resize(target_count(n.meshes), 0.0f);
  if (std::any_of(weights.begin(), weights.end(), [](float w) { return w != 0; })) json["weights"] = numbers(weights);
}

void NodeWriter::add_influences(OutputJson& attributes, const Mesh& m) {
  const auto per_vertex = static_cast<size_t>(m.influences_per_vertex);
  for (size_t set = 0; 4 * set < per_vertex; ++set) {
    std::vector<uint16_t> joints;
    std::vector<Vec4> weights;
    for (size_t v = 0; v < m.positions.size(); ++v) {
      Vec4& weight = weights.emplace_back(0.0f);
      for (size_t k = 4 * set; k < 4 * set + 4; ++k) {
        const JointInfluence influence = k < per_vertex ? m.influences[v * per_vertex + k] : JointInfluence{};
        joints.push_back(static_cast<uint16_t>(influence.joint));
        weight[static_cast<int>(k % 4)] = influence.weight;
      }
    }
    attributes[fmt::format("JOINTS_{}", set)] = output_.add_joints(joints);
    attributes[fmt::format("WEIGHTS_{}", set)] = output_.add_floats(flat<4>(weights), 4, BufferTarget::vertices);
  }
}

int NodeWriter::no_displacements(size_t vertices) {
  return output_.add_floats(flat<3>(std::vector<Vec3>(vertices, Vec3(0))), 3, BufferTarget::vertices, true);
}

void NodeWriter::add_morph_targets(OutputJson& json, const Mesh& m) {
  for (const MorphTarget& t : m.morph_targets) {
    OutputJson target = OutputJson::object();
    target["POSITION"] = t.positions.empty()
                             ? no_displacements(m.positions.size())
                             : output_.add_floats(flat<3>(t.positions), 3, BufferTarget::vertices, true);
    if (!t.normals.empty()) target["NORMAL"] = output_.add_floats(flat<3>(t.normals), 3, BufferTarget::vertices);
    if (!t.tangents.empty()) target["TANGENT"] = output_.add_floats(flat<3>(t.tangents), 3, BufferTarget::vertices);
    json["targets"].push_back(std::move(target));
  }
}

void NodeWriter::write_skins() {
  for (const Skin& skin : scene_.skins) {
    constexpr size_t kMostJoints = 65536;  // limit of JOINTS_n
    if (skin.joints.size() > kMostJoints)
      throw Error(fmt::format("{}: skin '{}' has {} joints, but glTF can number {}; split it", output_.place(),
                              skin.name, skin.joints.size(), kMostJoints));
    OutputJson json = OutputJson::object();
    if (!skin.name.empty()) json["name"] = skin.name;
    json["joints"] = skin.joints;
    json["inverseBindMatrices"] = output_.add_matrices(skin.inverse_bind);
    output_.add("skins", std::move(json));
  }
}

}  // namespace relume::gltf
