// Scenes of arbitrary triangles for tests of acceleration structures, and the hits that an exhaustive search finds.
#pragma once

#include <deque>
#include <vector>

#include "accel/accel_structure.h"
#include "accel/bvh/sheared_ray.h"
#include "accel/query.h"
#include "accel/triangle.h"
#include "core/hash.h"

namespace relume::testing {

/// Random numbers of a test.
class Random {
 public:
  explicit Random(uint32_t seed) : seed_(seed) {}
  uint32_t bits() { return hash(seed_, count_++); }
  /// Uniform in [low, high).
  float uniform(float low = 0, float high = 1) { return low + (high - low) * to_unit_float(bits()); }
  Vec3 point(float low, float high) { return {uniform(low, high), uniform(low, high), uniform(low, high)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = point(-1, 1);
      if (length_squared(p) <= 1.0f && length_squared(p) > 1e-4f) return glm::normalize(p);
    }
  }

 private:
  uint32_t seed_;
  uint32_t count_ = 0;
};

class Soup {
 public:
  /// Adds a mesh of separate triangles, three corners each. Returns its index.
  uint32_t add_mesh(const std::vector<Vec3>& corners) {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < corners.size(); ++i) indices.push_back(i);
    return add_mesh(corners, std::move(indices));
  }
  uint32_t add_mesh(std::vector<Vec3> vertices, std::vector<uint32_t> indices) {
    vertices.emplace_back(0);  // Embree reads 16 bytes at the last vertex
    vertices_.push_back(std::move(vertices));
    indices_.push_back(std::move(indices));
    AccelMesh& mesh = meshes.emplace_back();
    mesh.positions = &vertices_.back()[0].x;
    mesh.position_stride = sizeof(Vec3);
    mesh.vertex_count = vertices_.back().size() - 1;
    mesh.indices = indices_.back().data();
    mesh.triangle_count = indices_.back().size() / 3;
    return static_cast<uint32_t>(meshes.size() - 1);
  }
  std::vector<Vec3>& vertices(uint32_t mesh) { return vertices_[mesh]; }

  /// Adds an instance in world space, or with a transform.
  void add_instance(uint32_t mesh) { instances.push_back({.mesh = mesh}); }
  void add_instance(uint32_t mesh, const Mat4& to_world) {
    instances.push_back({.mesh = mesh, .to_world = to_world, .in_world_space = false});
  }

  /// Calls f(instance, primitive, p0, p1, p2) for every visible triangle, with corners in world space.
  template <typename F>
  void for_each_triangle(const F& f) const {
    for (uint32_t i = 0; i < instances.size(); ++i) {
      const AccelInstance& instance = instances[i];
      const AccelMesh& mesh = meshes[instance.mesh];
      for (uint32_t t = 0; instance.visible && t < mesh.triangle_count; ++t) {
        Vec3 p[3];
        for (uint32_t k = 0; k < 3; ++k) {
          p[k] = vertex_position(mesh, mesh.indices[3 * t + k]);
          if (!instance.in_world_space) p[k] = transform_point(instance.to_world, p[k]);
        }
        f(i, t, p[0], p[1], p[2]);
      }
    }
  }

  float opacity_of(uint32_t instance, uint32_t primitive, float u, float v) const {
    return opacity.function ? opacity.function(opacity.context, instance, primitive, u, v) : 1.0f;
  }

  std::vector<AccelMesh> meshes;
  std::vector<AccelInstance> instances;
  OpacityFunction opacity;

 private:
  std::deque<std::vector<Vec3>> vertices_;
  std::deque<std::vector<uint32_t>> indices_;
};

/// The nearest hit among all triangles. `camera`: kFromCamera, kToCamera or 0.
inline Hit exhaustive_hit(const Soup& soup, const Ray& ray, uint32_t ray_id, unsigned camera = 0) {
  Hit best;
  float nearest = ray.t_max;
  const ShearedRay sheared(ray.origin, ray.direction);
  soup.for_each_triangle([&](uint32_t i, uint32_t t, const Vec3& p0, const Vec3& p1, const Vec3& p2) {
    Crossing crossing;
    if (!sheared.crosses(p0, p1, p2, nearest, crossing) || (crossing.t == nearest && best.valid())) return;
    const AccelInstance& instance = soup.instances[i];
    const AccelMesh& mesh = soup.meshes[instance.mesh];
    const bool mirrored = !instance.in_world_space && glm::determinant(Mat3(instance.to_world)) < 0;
    if (mesh.culls_back_faces && camera != 0 && (crossing.at_back != mirrored) == (camera == kFromCamera)) return;
    const TriangleHit on = intersect_triangle(ray.origin, ray.direction, p0, p1, p2);
    if (mesh.needs_opacity && !stops(soup.opacity_of(i, t, on.u, on.v), ray_id, i, t)) return;
    best = {i, t, on.u, on.v, on.t};
    nearest = crossing.t;
  });
  return best;
}

}  // namespace relume::testing
