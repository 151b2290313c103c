#include "scene_io/gltf/gltf_nodes.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "scene_io/gltf/gltf_accessor.h"
#include "scene_io/gltf/gltf_skins.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

/// Parent of each node, -1 for roots.
std::vector<int> find_parents(const Document& document) {
  const auto& nodes = document.model.nodes;
  std::vector<int> parents(nodes.size(), -1);
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      if (child < 0 || static_cast<size_t>(child) >= nodes.size())
        document.damaged(fmt::format("node {} has the child {}, which does not exist", i, child));
      int& parent = parents[static_cast<size_t>(child)];
      if (parent == static_cast<int>(i))
        document.damaged(fmt::format("node {} is listed twice as a child of node {}", child, i));
      if (parent != -1)
        document.fail(fmt::format("node {} has two parents, {} and {}; glTF allows one", child, parent, i));
      parent = static_cast<int>(i);
    }
  }
  return parents;
}

/// Nodes reachable from `roots`, parents first. From all roots, exactly the nodes in cycles are missing, since each
/// node has at most one parent.
std::vector<int> walk(const tinygltf::Model& model, const std::vector<int>& roots) {
  std::vector<int> order = roots;
  for (size_t k = 0; k < order.size(); ++k) {
    const auto& children = model.nodes[static_cast<size_t>(order[k])].children;
    order.insert(order.end(), children.begin(), children.end());
  }
  return order;
}

std::vector<int> all_roots(const std::vector<int>& parents) {
  std::vector<int> roots;
  for (size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == -1) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

std::vector<int> scene_roots(Document& document, const std::vector<int>& parents) {
  const tinygltf::Model& model = document.model;
  if (model.scenes.empty()) return all_roots(parents);
  size_t scene = 0;
  if (model.defaultScene >= 0 && static_cast<size_t>(model.defaultScene) < model.scenes.size()) {
    scene = static_cast<size_t>(model.defaultScene);
  } else if (model.defaultScene != -1) {
    document.warnings.add(fmt::format("the default scene {} does not exist; scene 0 is loaded", model.defaultScene));
  }
  if (model.scenes.size() > 1)
    document.warnings.add(fmt::format("the file has {} scenes; scene {} is loaded", model.scenes.size(), scene));
  std::vector<int> roots;
  std::vector<bool> taken(parents.size(), false);
  for (const int root : model.scenes[scene].nodes) {
    if (root < 0 || static_cast<size_t>(root) >= parents.size())
      document.damaged(fmt::format("scene {} lists node {}, which does not exist", scene, root));
    if (parents[static_cast<size_t>(root)] != -1)
      document.damaged(fmt::format("scene {} lists node {}, which is a child of another node", scene, root));
    if (!taken[static_cast<size_t>(root)]) roots.push_back(root);
    taken[static_cast<size_t>(root)] = true;
  }
  return roots;
}

glm::quat to_rotation(const std::vector<double>& xyzw) {
  if (xyzw.size() < 4) return {1, 0, 0, 0};
  const glm::quat q(to_float(xyzw[3]), to_float(xyzw[0]), to_float(xyzw[1]), to_float(xyzw[2]));
  const float length = glm::length(q);
  return length > 0 && is_finite(length) ? q / length : glm::quat(1, 0, 0, 0);
}

void convert_matrix(Document& document, const tinygltf::Node& source, Node& node) {
  Mat4 matrix(1);
  for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = to_float(source.matrix[static_cast<size_t>(i)]);
  const Vec4 last_row(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]);
  if (last_row != Vec4(0, 0, 0, 1)) {
    document.warnings.add(
        fmt::format("node '{}': its matrix is not affine; the projective part is ignored", node.name));
    for (int c = 0; c < 4; ++c) matrix[c][3] = c == 3 ? 1.0f : 0.0f;
  }
  node.matrix = matrix;
}

void convert_transform(Document& document, const tinygltf::Node& source, Node& node) {
  if (source.matrix.size() == 16) {
    convert_matrix(document, source, node);
    return;
  }
  node.transform.translation = to_vec3(source.translation, Vec3(0));
  node.transform.rotation = to_rotation(source.rotation);
  node.transform.scale = to_vec3(source.scale, Vec3(1));
}

/// EXT_mesh_gpu_instancing: one matrix per instance.
std::vector<Mat4> read_instances(Document& document, const tinygltf::Value& extension, const std::string& node) {
  const tinygltf::Value* attributes = object_member(extension, "attributes");
  if (!attributes) return {};
  const auto accessor = [&](const char* name) { return integer_member(*attributes, name, -1); };
  std::vector<Vec3> translations;
  std::vector<Vec4> rotations;
  std::vector<Vec3> scales;
  if (accessor("TRANSLATION") >= 0) translations = read_vec3(document, accessor("TRANSLATION"));
  if (accessor("ROTATION") >= 0) rotations = read_vec4(document, accessor("ROTATION"));
  if (accessor("SCALE") >= 0) scales = read_vec3(document, accessor("SCALE"));
  const size_t count = std::max({translations.size(), rotations.size(), scales.size()});
  const auto agrees = [&](size_t size) { return size == 0 || size == count; };
  if (!agrees(translations.size()) || !agrees(rotations.size()) || !agrees(scales.size()))
    document.damaged(fmt::format("node '{}': its instances have attributes of different lengths", node));
  std::vector<Mat4> instances(count, Mat4(1));
  for (size_t i = 0; i < count; ++i) {
    Transform t;
    if (!translations.empty()) t.translation = translations[i];
    if (!rotations.empty()) t.rotation = to_rotation({rotations[i].x, rotations[i].y, rotations[i].z, rotations[i].w});
    if (!scales.empty()) t.scale = scales[i];
    if (!is_finite(t.translation) || !is_finite(t.scale))
      document.damaged(fmt::format("node '{}': instance {} is not finite", node, i));
    instances[i] = glm::translate(Mat4(1), t.translation) * glm::mat4_cast(t.rotation) * glm::scale(Mat4(1), t.scale);
  }
  return instances;
}

Node convert_node(Document& document, Scene& scene, MeshImporter& meshes, PunctualImporter& punctual, int index) {
  const tinygltf::Node& source = document.model.nodes[static_cast<size_t>(index)];
  Node node;
  node.name = source.name.empty() ? fmt::format("node {}", index) : source.name;
  convert_transform(document, source, node);
  if (source.mesh >= 0) node.meshes = meshes.import(source.mesh);
  if (source.skin >= 0 && source.mesh >= 0) node.skin = source.skin;  // import_skins() replaces it by the scene's index
  node.morph_weights = default_morph_weights(document.model, source);
  const auto visibility = source.extensions.find("KHR_node_visibility");
  if (visibility != source.extensions.end()) node.visible = boolean_member(visibility->second, "visible", true);
  if (source.camera >= 0) node.camera = punctual.import_camera(source.camera, scene);
  const auto light = source.extensions.find("KHR_lights_punctual");
  if (light != source.extensions.end())
    node.light = punctual.import_light(integer_member(light->second, "light", -1), scene);
  const auto instancing = source.extensions.find("EXT_mesh_gpu_instancing");
  if (instancing != source.extensions.end()) node.instances = read_instances(document, instancing->second, node.name);
  return node;
}

}  // namespace

std::vector<Index> import_nodes(Document& document, Scene& scene, MeshImporter& meshes, PunctualImporter& punctual) {
  const std::vector<int> parents = find_parents(document);
  if (walk(document.model, all_roots(parents)).size() != parents.size())
    document.damaged("its node tree has a cycle: a node is its own ancestor");
  const std::vector<int> order = walk(document.model, scene_roots(document, parents));
  std::vector<Index> node_of(parents.size(), kNone);
  for (size_t k = 0; k < order.size(); ++k) node_of[static_cast<size_t>(order[k])] = static_cast<Index>(k);
  scene.nodes.reserve(order.size());
  for (const int index : order) {
    Node node = convert_node(document, scene, meshes, punctual, index);
    const int parent = parents[static_cast<size_t>(index)];
    if (parent != -1) node.parent = node_of[static_cast<size_t>(parent)];
    scene.add_node(std::move(node));
  }
  return node_of;
}

}  // namespace relume::gltf
