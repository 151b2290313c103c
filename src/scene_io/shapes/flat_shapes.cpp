#include "scene_io/shapes/flat_shapes.h"

#include <glm/common.hpp>

#include "core/vec.h"

namespace relume {
namespace {

template <typename V>
V bilinear(const std::array<V, 4>& c, float u, float v) {
  return (1 - v) * ((1 - u) * c[0] + u * c[1]) + v * ((1 - u) * c[2] + u * c[3]);
}

template <typename V>
std::array<V, 4> corners(std::span<const V> values, const std::array<uint32_t, 4>& patch) {
  return {values[patch[0]], values[patch[1]], values[patch[2]], values[patch[3]]};
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const float length = glm::length(v);
  return length > 0 && is_finite(length) ? v / length : otherwise;
}

/// Normal of the patch itself.
Vec3 normal_at(const std::array<Vec3, 4>& p, float u, float v) {
  const Vec3 du = glm::mix(p[1] - p[0], p[3] - p[2], v);
  const Vec3 dv = glm::mix(p[2] - p[0], p[3] - p[1], u);
  return unit_or(glm::cross(du, dv), Vec3(0, 0, 1));
}

bool is_parallelogram(const std::array<Vec3, 4>& p) {
  const Vec3 excess = p[3] - p[1] - p[2] + p[0];
  return glm::length(excess) <= 1e-5f * (glm::length(p[3] - p[0]) + glm::length(p[2] - p[1]));
}

void add_patch(Mesh& mesh, const BilinearPatches& patches, const std::array<uint32_t, 4>& patch, int most_cells) {
  const std::array<Vec3, 4> positions = corners(patches.positions, patch);
  const bool has_normals = !patches.normals.empty();
  const int cells = is_parallelogram(positions) ? 1 : most_cells;
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(cells);
      const float v = static_cast<float>(j) / static_cast<float>(cells);
      const Vec3 own = normal_at(positions, u, v);
      const Vec2 st = patches.uv.empty() ? Vec2(u, v) : bilinear(corners(patches.uv, patch), u, v);
      mesh.positions.push_back(bilinear(positions, u, v));
      mesh.normals.push_back(has_normals ? unit_or(bilinear(corners(patches.normals, patch), u, v), own) : own);
      mesh.uv0.emplace_back(st.x, 1 - st.y);
    }
  }
  const auto stride = static_cast<uint32_t>(cells) + 1;
  for (uint32_t j = 0; j + 1 < stride; ++j) {
    for (uint32_t i = 0; i + 1 < stride; ++i) {
      const uint32_t a = first + j * stride + i;
      mesh.triangles.emplace_back(a, a + 1, a + stride + 1);
      mesh.triangles.emplace_back(a, a + stride + 1, a + stride);
    }
  }
}

}  // namespace

Mesh rectangle_mesh() {
  Mesh mesh;
  for (const Vec2 corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    mesh.positions.emplace_back(2 * corner.x - 1, 2 * corner.y - 1, 0);
    mesh.normals.emplace_back(0, 0, 1);
    mesh.uv0.emplace_back(corner.x, 1 - corner.y);
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh bilinear_mesh(const BilinearPatches& patches, int cells) {
  Mesh mesh;
  for (const auto& patch : patches.patches) add_patch(mesh, patches, patch, cells);
  return mesh;
}

}  // namespace relume
