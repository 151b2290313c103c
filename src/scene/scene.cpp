#include "scene/scene.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>

#include "relume/error.h"
#include "scene/animation.h"

namespace relume {
namespace {

Mat4 matrix_of(const Transform& t) {
  return glm::translate(Mat4(1), t.translation) * glm::mat4_cast(t.rotation) * glm::scale(Mat4(1), t.scale);
}

/// Node indices with parents before their children. The hierarchy must have no cycles.
std::vector<size_t> topological_order(const Scene& scene) {
  const size_t count = scene.nodes.size();
  std::vector<std::vector<size_t>> children(count);
  std::vector<size_t> order;
  order.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const Index parent = scene.nodes[i].parent;
    if (parent == kNone) {
      order.push_back(i);
    } else {
      children[static_cast<size_t>(parent)].push_back(i);
    }
  }
  for (size_t k = 0; k < order.size(); ++k) {
    const auto& next = children[order[k]];
    order.insert(order.end(), next.begin(), next.end());
  }
  return order;
}

void hide_descendants(const Scene& scene, std::vector<bool>& visible) {
  for (const size_t i : topological_order(scene)) {
    const Index parent = scene.nodes[i].parent;
    if (parent != kNone && !visible[static_cast<size_t>(parent)]) visible[i] = false;
  }
}

/// The channels of a scene from last to first, so that the first one of a property wins. Clang 14 cannot compile
/// std::views of libstdc++ 12.
struct ReversedChannels {
  const std::vector<AnimationChannel>& channels;

  explicit ReversedChannels(const Scene& scene) : channels(scene.animation) {}
  auto begin() const { return channels.rbegin(); }
  auto end() const { return channels.rend(); }
};

}  // namespace

std::vector<Mat4> world_matrices(const Scene& scene, float time_s) {
  std::vector<Transform> transforms(scene.nodes.size());
  for (size_t i = 0; i < scene.nodes.size(); ++i) transforms[i] = scene.nodes[i].transform;
  std::vector<bool> animated(scene.nodes.size(), false);
  for (const AnimationChannel& channel : ReversedChannels(scene)) {
    if (!is_transform(channel.property)) continue;
    apply(channel, time_s, transforms[static_cast<size_t>(channel.node)]);
    animated[static_cast<size_t>(channel.node)] = true;
  }
  std::vector<Mat4> world(scene.nodes.size(), Mat4(1));
  for (const size_t i : topological_order(scene)) {
    const Node& node = scene.nodes[i];
    const Mat4 local = node.matrix && !animated[i] ? *node.matrix : matrix_of(transforms[i]);
    world[i] = node.parent == kNone ? local : world[static_cast<size_t>(node.parent)] * local;
  }
  return world;
}

std::vector<bool> visible_nodes(const Scene& scene, float time_s) {
  std::vector<bool> visible;
  for (const Node& node : scene.nodes) visible.push_back(node.visible);
  for (const AnimationChannel& channel : ReversedChannels(scene)) {
    if (channel.property == AnimatedProperty::visible)
      visible[static_cast<size_t>(channel.node)] = evaluate(channel, time_s).x != 0;
  }
  hide_descendants(scene, visible);
  return visible;
}

std::vector<bool> ever_visible_nodes(const Scene& scene) {
  std::vector<bool> visible;
  for (const Node& node : scene.nodes) visible.push_back(node.visible);
  for (const AnimationChannel& channel : ReversedChannels(scene)) {
    if (channel.property == AnimatedProperty::visible)
      visible[static_cast<size_t>(channel.node)] = value_range(channel).high > 0;
  }
  hide_descendants(scene, visible);
  return visible;
}

std::vector<float> morph_weights(const Scene& scene, Index node, float time_s) {
  std::vector<float> weights = scene.nodes[static_cast<size_t>(node)].morph_weights;
  for (const AnimationChannel& channel : ReversedChannels(scene)) {
    if (channel.property != AnimatedProperty::morph_weight || channel.node != node) continue;
    const auto target = static_cast<size_t>(channel.morph_target);
    if (target >= weights.size()) weights.resize(target + 1, 0.0f);
    weights[target] = evaluate(channel, time_s).x;
  }
  return weights;
}

void choose_variant(Scene& scene, const std::string& name) {
  const auto found = std::find(scene.variants.begin(), scene.variants.end(), name);
  if (found == scene.variants.end() && !name.empty()) {
    const std::string known = scene.variants.empty()
                                  ? "the scene has no variants; choose none"
                                  : fmt::format("choose one of '{}'", fmt::join(scene.variants, "', '"));
    throw Error(ErrorCode::not_found, fmt::format("{}: there is no variant '{}'; {}", error_place(scene), name, known));
  }
  const auto variant = static_cast<Index>(found - scene.variants.begin());
  for (Mesh& mesh : scene.meshes) {
    if (mesh.variants.empty()) continue;
    if (!mesh.default_material) mesh.default_material = mesh.material;
    mesh.material = *mesh.default_material;
    for (const VariantMaterial& choice : mesh.variants) {
      if (choice.variant == variant) mesh.material = choice.material;
    }
  }
}

size_t placed_triangles(const Scene& scene) {
  size_t sum = 0;
  for (const Node& node : scene.nodes) {
    for_each_place(node,
                   [&](Index mesh, const Mat4&) { sum += scene.meshes[static_cast<size_t>(mesh)].triangles.size(); });
  }
  return sum;
}

std::vector<Box> mesh_boxes(const Scene& scene) {
  std::vector<Box> boxes;
  for (const Mesh& mesh : scene.meshes) {
    Box& box = boxes.emplace_back();
    for (const Vec3& position : mesh.positions) box.add(position);
  }
  return boxes;
}

void check_index(Index index, size_t count, const char* kind, const std::string& place) {
  if (index >= 0 && static_cast<size_t>(index) < count) return;
  const std::string valid =
      count == 0 ? fmt::format("the scene has no {}s", kind) : fmt::format("give an index from 0 to {}", count - 1);
  throw Error(ErrorCode::invalid_handle, fmt::format("{}: {} {} does not exist; {}", place, kind, index, valid));
}

std::vector<bool> moving_nodes(const Scene& scene, const std::vector<Index>& movable) {
  std::vector<bool> moves(scene.nodes.size(), false);
  for (const Index node : movable) {
    check_index(node, scene.nodes.size(), "node", error_place(scene));
    moves[static_cast<size_t>(node)] = true;
  }
  for (const AnimationChannel& channel : scene.animation) moves[static_cast<size_t>(channel.node)] = true;
  for (const size_t i : topological_order(scene)) {
    const Index parent = scene.nodes[i].parent;
    if (parent != kNone && moves[static_cast<size_t>(parent)]) moves[i] = true;
  }
  return moves;
}

Transform look_at(const Vec3& eye, const Vec3& target) {
  const Vec3 direction = target - eye;
  const bool is_vertical = std::hypot(direction.x, direction.z) <= 1e-6f * std::abs(direction.y);
  const Mat4 view = glm::lookAt(eye, target, is_vertical ? Vec3(0, 0, -1) : Vec3(0, 1, 0));
  Transform transform;
  transform.translation = eye;
  transform.rotation = glm::normalize(glm::quat_cast(glm::transpose(Mat3(view))));
  return transform;
}

}  // namespace relume
