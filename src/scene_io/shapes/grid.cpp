#include "scene_io/shapes/grid.h"

namespace relume {

Mesh grid_mesh(int count_u, int count_v, const std::function<GridVertex(float u, float v)>& vertex) {
  Mesh mesh;
  for (int j = 0; j <= count_v; ++j) {
    for (int i = 0; i <= count_u; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(count_u);
      const float v = static_cast<float>(j) / static_cast<float>(count_v);
      const GridVertex made = vertex(u, v);
      mesh.positions.push_back(made.position);
      mesh.normals.push_back(made.normal);
      mesh.uv0.emplace_back(u, 1 - v);
    }
  }
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    if (p != q && q != r && r != p) mesh.triangles.emplace_back(a, b, c);
  };
  const auto stride = static_cast<uint32_t>(count_u) + 1;
  for (uint32_t j = 0; j < static_cast<uint32_t>(count_v); ++j) {
    for (uint32_t i = 0; i + 1 < stride; ++i) {
      const uint32_t a = j * stride + i;
      add(a, a + 1, a + stride + 1);
      add(a, a + stride + 1, a + stride);
    }
  }
  return mesh;
}

}  // namespace relume
