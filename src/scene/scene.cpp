#include "scene/scene.h"

#include <algorithm>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

Mat4 matrix_of(const Transform& t) {
  return glm::translate(Mat4(1), t.translation) * glm::mat4_cast(t.rotation) * glm::scale(Mat4(1), t.scale);
}

glm::quat quat_from_xyzw(const Vec4& v) { return {v.w, v.x, v.y, v.z}; }

/// Value of key `i` itself, without the tangents of a cubic spline.
Vec4 key_value(const AnimationChannel& channel, size_t i) {
  return channel.interpolation == Interpolation::cubic_spline ? channel.values[3 * i + 1] : channel.values[i];
}

/// glTF 2.0, appendix C: Hermite spline with tangents scaled by the interval `dt`.
Vec4 cubic_spline(const AnimationChannel& channel, size_t i, float dt, float t) {
  const Vec4 v0 = channel.values[3 * i + 1];
  const Vec4 b0 = channel.values[3 * i + 2] * dt;
  const Vec4 a1 = channel.values[3 * i + 3] * dt;
  const Vec4 v1 = channel.values[3 * i + 4];
  const float t2 = t * t;
  const float t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * v0 + (t3 - 2 * t2 + t) * b0 + (-2 * t3 + 3 * t2) * v1 + (t3 - t2) * a1;
}

Vec4 evaluate(const AnimationChannel& channel, float time_s) {
  const auto& times = channel.times;
  if (!(time_s > times.front())) return key_value(channel, 0);  // what is no number too
  if (time_s >= times.back()) return key_value(channel, times.size() - 1);
  const auto next = std::upper_bound(times.begin(), times.end(), time_s);
  const size_t i = static_cast<size_t>(next - times.begin()) - 1;
  const float dt = times[i + 1] - times[i];
  const float t = (time_s - times[i]) / dt;
  switch (channel.interpolation) {
    case Interpolation::step: return key_value(channel, i);
    case Interpolation::cubic_spline: return cubic_spline(channel, i, dt, t);
    case Interpolation::linear: break;
  }
  const Vec4 a = channel.values[i];
  const Vec4 b = channel.values[i + 1];
  if (channel.property != AnimatedProperty::rotation) return a + (b - a) * t;
  const glm::quat q = glm::slerp(quat_from_xyzw(a), quat_from_xyzw(b), t);
  return {q.x, q.y, q.z, q.w};
}

void apply(const AnimationChannel& channel, float time_s, Transform& transform) {
  const Vec4 value = evaluate(channel, time_s);
  switch (channel.property) {
    case AnimatedProperty::translation: transform.translation = Vec3(value); break;
    case AnimatedProperty::rotation: transform.rotation = glm::normalize(quat_from_xyzw(value)); break;
    case AnimatedProperty::scale: transform.scale = Vec3(value); break;
  }
}

/// Node indices such that parents come before their children. Nodes must have no cycles.
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

}  // namespace

std::vector<Mat4> world_matrices(const Scene& scene, float time_s) {
  std::vector<Transform> transforms(scene.nodes.size());
  for (size_t i = 0; i < scene.nodes.size(); ++i) transforms[i] = scene.nodes[i].transform;
  std::vector<bool> animated(scene.nodes.size(), false);
  for (const AnimationChannel& channel : scene.animation) {
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

std::vector<bool> moving_nodes(const Scene& scene, const std::vector<Index>& movable) {
  std::vector<bool> moves(scene.nodes.size(), false);
  for (const Index node : movable) moves[static_cast<size_t>(node)] = true;
  for (const AnimationChannel& channel : scene.animation) moves[static_cast<size_t>(channel.node)] = true;
  for (const size_t i : topological_order(scene)) {
    const Index parent = scene.nodes[i].parent;
    if (parent != kNone && moves[static_cast<size_t>(parent)]) moves[i] = true;
  }
  return moves;
}

float animation_end(const Scene& scene) {
  float end = 0;
  for (const AnimationChannel& channel : scene.animation) end = std::max(end, channel.times.back());
  return end;
}

Transform look_at(const Vec3& eye, const Vec3& target) {
  const Mat4 view = glm::lookAt(eye, target, Vec3(0, 1, 0));
  Transform transform;
  transform.translation = eye;
  transform.rotation = glm::normalize(glm::quat_cast(glm::transpose(Mat3(view))));
  return transform;
}

}  // namespace relume
