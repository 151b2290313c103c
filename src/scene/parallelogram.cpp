#include "scene/parallelogram.h"

#include "scene/surface_point.h"

namespace relume {
namespace {

/// Largest deviation, as a fraction of the diagonal.
constexpr float kMostDeviation = 1e-5f;

/// Bound on the rounding error of a vertex in world space.
float rounding(const Vec3& p) { return gamma_bound(7) * max_component(abs(p)); }

}  // namespace

std::optional<Parallelogram> find_parallelogram(View<const Vertex> vertices, const UVec3& a, const UVec3& b) {
  const auto at = [&](uint32_t v) { return vertices[v].position; };
  for (int i = 0; i < 3; ++i) {
    const uint32_t corner = a[i];
    const uint32_t first = a[(i + 1) % 3];
    const uint32_t second = a[(i + 2) % 3];
    for (int k = 0; k < 3; ++k) {
      if (at(b[k]) != at(second) || at(b[(k + 1) % 3]) != at(first)) continue;  // the same edge, in the other direction
      const Vec3 e1 = at(first) - at(corner);
      const Vec3 e2 = at(second) - at(corner);
      const Vec3 fourth = at(b[(k + 2) % 3]);
      const float deviation = glm::length(fourth - (at(corner) + e1 + e2));
      const bool fits = deviation <= kMostDeviation * glm::length(e1 + e2) + rounding(fourth);
      if (!fits || !(length_squared(glm::cross(e1, e2)) > 0.0f)) return std::nullopt;
      return Parallelogram{corner, first, second, deviation};
    }
  }
  return std::nullopt;
}

bool consists_of_parallelograms(const SceneView& geometry, const MeshView& mesh) {
  if (mesh.triangle_count == 0 || mesh.triangle_count % 2 != 0) return false;
  for (uint32_t k = mesh.first_triangle; k < mesh.first_triangle + mesh.triangle_count; k += 2) {
    if (!find_parallelogram(geometry.vertices, geometry.triangles[k], geometry.triangles[k + 1])) return false;
  }
  return true;
}

}  // namespace relume
