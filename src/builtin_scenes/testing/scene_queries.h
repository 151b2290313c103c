// Counts and brute-force rays for tests of built-in scenes.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "builtin_scenes/builtin.h"

namespace relume::testing {

/// Builds every scene once for all tests.
inline const Scene& scene_named(std::string_view name) {
  static std::map<std::string, Scene, std::less<>> built;
  const auto [entry, is_new] = built.try_emplace(std::string(name));
  if (is_new) entry->second = find_builtin_scene(name)->build();
  return entry->second;
}

inline size_t copies(const Node& node) { return node.instances.empty() ? 1 : node.instances.size(); }

/// Triangles over all copies, of the materials that `counts` accepts.
template <typename Predicate>
size_t triangle_count(const Scene& scene, Predicate counts) {
  size_t sum = 0;
  for (const Node& node : scene.nodes) {
    for (const Index i : node.meshes) {
      const Mesh& mesh = scene.meshes[static_cast<size_t>(i)];
      if (counts(scene.materials[static_cast<size_t>(mesh.material)])) sum += copies(node) * mesh.triangles.size();
    }
  }
  return sum;
}

inline size_t triangle_count(const Scene& scene) {
  return triangle_count(scene, [](const Material&) { return true; });
}

inline size_t emissive_count(const Scene& scene) {
  return triangle_count(scene, [](const Material& m) { return !is_black(m.emission); });
}

/// Area of the emissive meshes, each counted once and untransformed.
inline float emissive_area(const Scene& scene) {
  float area = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (is_black(scene.materials[static_cast<size_t>(mesh.material)].emission)) continue;
    for (const UVec3& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t.x];
      area += 0.5f * glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
    }
  }
  return area;
}

/// The first node with a camera. Throws std::out_of_range if there is none.
inline size_t camera_node(const Scene& scene) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].camera != kNone) return i;
  }
  throw std::out_of_range("no camera");
}

struct Hit {
  float distance = kInfinity;
  const Material* material = nullptr;
  bool front = false;
};

/// Nearest intersection at `time_s` by brute force over all triangles (Möller and Trumbore 1997).
inline Hit trace(const Scene& scene, const Vec3& origin, const Vec3& direction, float time_s = 0) {
  Hit hit;
  const std::vector<Mat4> world = world_matrices(scene, time_s);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    for (size_t k = 0; k < copies(node); ++k) {
      const Mat4 matrix = glm::inverse(node.instances.empty() ? world[i] : world[i] * node.instances[k]);
      const Vec3 o = transform_point(matrix, origin);
      const Vec3 d = transform_vector(matrix, direction);
      for (const Index m : node.meshes) {
        const Mesh& mesh = scene.meshes[static_cast<size_t>(m)];
        for (const UVec3& t : mesh.triangles) {
          const Vec3 a = mesh.positions[t.x];
          const Vec3 e1 = mesh.positions[t.y] - a;
          const Vec3 e2 = mesh.positions[t.z] - a;
          const Vec3 p = glm::cross(d, e2);
          const float det = glm::dot(e1, p);
          if (det == 0) continue;
          const float u = glm::dot(o - a, p) / det;
          if (u < 0 || u > 1) continue;
          const Vec3 q = glm::cross(o - a, e1);
          const float v = glm::dot(d, q) / det;
          const float distance = glm::dot(e2, q) / det;
          if (v < 0 || u + v > 1 || distance <= 1e-4f || distance >= hit.distance) continue;
          hit = {distance, &scene.materials[static_cast<size_t>(mesh.material)], det > 0};
        }
      }
    }
  }
  return hit;
}

/// Evenly spread unit directions (Fibonacci lattice).
inline Vec3 spread(int i, int count) {
  const float y = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
  const float angle = static_cast<float>(i) * kPi * (3 - std::sqrt(5.0f));
  const float r = safe_sqrt(1 - y * y);
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

}  // namespace relume::testing
