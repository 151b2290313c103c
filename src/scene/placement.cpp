#include "scene/placement.h"

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {
namespace {

bool holds_something(const Node& node) { return !node.meshes.empty() || node.light != kNone || node.camera != kNone; }

bool node_within_reach(const Node& node, const Mat4& world) {
  if (!within_reach(world)) return false;
  for (const Mat4& local : node.instances) {
    if (!within_reach(local) || !within_reach(world * local)) return false;
  }
  return true;
}

}  // namespace

bool within_reach(const Mat4& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::fabs(m[column][row]) <= kMaxCoordinate)) return false;
    }
  }
  return true;
}

Vec3 direction_of(const Vec3& v) {
  const float largest = max_component(abs(v));
  return largest > 0.0f ? glm::normalize(v / largest) : Vec3(0);
}

std::optional<Mat3> orientation(const Mat4& to_world) {
  constexpr float kParallel = 1e-6f;  // rounding error of the cross product's length
  const Vec3 z = direction_of(Vec3(to_world[2]));
  const Vec3 x = glm::cross(direction_of(Vec3(to_world[1])), z);
  if (!(glm::length(x) > kParallel)) return std::nullopt;
  const Vec3 unit_x = glm::normalize(x);
  return Mat3(unit_x, glm::cross(z, unit_x), z);
}

void check_placement(const Scene& scene, std::span<const Mat4> world, const std::string& place) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    if (!holds_something(node) || node_within_reach(node, world[i])) continue;
    throw Error(
        fmt::format("{}: node {} '{}' is moved or scaled beyond {:g} m, or its transform is not finite; scale the "
                    "scene down, or correct the transforms of the node and its ancestors",
                    place, i, node.name, kMaxCoordinate));
  }
}

}  // namespace relume
