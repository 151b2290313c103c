#include "scene/world_triangles.h"

#include <algorithm>
#include <vector>

namespace relume {
namespace {

/// Bounds of the mesh in mesh space.
Box mesh_box(const SceneView& scene, const MeshView& mesh) {
  Box box;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const UVec3 index = scene.triangles[mesh.first_triangle + t];
    for (int k = 0; k < 3; ++k) box.add(scene.vertices[index[k]].position);
  }
  return box;
}

/// Conservative bounds of the instance. The margin covers rounding differences between ways to compute a point.
Box outer_box(const Box& mesh, const Instance& instance) {
  if (mesh.empty() || instance.in_world_space) return mesh;
  Box box;
  for (int corner = 0; corner < 8; ++corner) {
    box.add(instance.to_world.point({(corner & 1) != 0 ? mesh.high.x : mesh.low.x,
                                     (corner & 2) != 0 ? mesh.high.y : mesh.low.y,
                                     (corner & 4) != 0 ? mesh.high.z : mesh.low.z}));
  }
  constexpr float kRounding = 1e-5f;
  const Vec3 margin = kRounding * (box.extent() + glm::max(glm::abs(box.low), glm::abs(box.high)));
  return {box.low - margin, box.high + margin};
}

bool contains(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThanEqual(outer.low, inner.low)) && glm::all(glm::greaterThanEqual(outer.high, inner.high));
}

}  // namespace

Box world_box(const SceneView& scene) {
  std::vector<Box> meshes;
  for (const MeshView& mesh : scene.meshes) meshes.push_back(mesh_box(scene, mesh));
  std::vector<Box> outer;
  for (const Instance& instance : scene.instances) outer.push_back(outer_box(meshes[instance.mesh], instance));
  Box box;
  const auto add = [&](size_t i) {
    if (outer[i].empty() || contains(box, outer[i])) return;
    for_each_world_triangle(scene, scene.instances[static_cast<uint32_t>(i)],
                            [&](const Vec3& a, const Vec3& b, const Vec3& c) {
                              for (const Vec3& corner : {a, b, c}) box.add(corner);
                            });
  };
  if (outer.empty()) return box;
  // Instances that reach farthest come first, so most others can be skipped.
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = [&](const Box& a, const Box& b) { return a.low[axis] < b.low[axis]; };
    const auto high = [&](const Box& a, const Box& b) { return a.high[axis] < b.high[axis]; };
    add(static_cast<size_t>(std::min_element(outer.begin(), outer.end(), low) - outer.begin()));
    add(static_cast<size_t>(std::max_element(outer.begin(), outer.end(), high) - outer.begin()));
  }
  for (size_t i = 0; i < outer.size(); ++i) add(i);
  return box;
}

}  // namespace relume
