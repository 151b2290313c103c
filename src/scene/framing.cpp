#include "scene/framing.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace relume {
namespace {

/// Bounds of all points, which determine the nearest camera. The axes are the camera's, with z towards the eye. A view
/// of slope k contains a point (x, y, z) if |x - eye.x| <= k (eye.z - z), and likewise for y.
struct Reach {
  Vec2 right{-kInfinity};  ///< x + k z
  Vec2 left{-kInfinity};   ///< -x + k z
  float nearest = -kInfinity;
  float farthest = kInfinity;

  void add(const Vec3& p, const Vec2& slope) {
    right = glm::max(right, Vec2(p) + slope * p.z);
    left = glm::max(left, -Vec2(p) + slope * p.z);
    nearest = std::max(nearest, p.z);
    farthest = std::min(farthest, p.z);
  }
  void add(const Reach& other) {
    right = glm::max(right, other.right);
    left = glm::max(left, other.left);
    nearest = std::max(nearest, other.nearest);
    farthest = std::min(farthest, other.farthest);
  }
};

Reach reach_of(const SceneView& scene, const Instance& instance, const Mat3& to_axes, const Vec3& center,
               const Vec2& slope) {
  const MeshView& mesh = scene.meshes[instance.mesh];
  Reach reach;
  if (!instance.visible) return reach;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const UVec3 index = scene.triangles[mesh.first_triangle + t];
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = scene.vertices[index[k]].position;
      reach.add(to_axes * ((instance.in_world_space ? p : instance.to_world.point(p)) - center), slope);
    }
  }
  return reach;
}

Reach reach_of(const SceneView& scene, const Mat3& to_axes, const Vec3& center, const Vec2& slope) {
  std::vector<Reach> reaches(scene.instances.size);
  parallel_for(reaches.size(), [&](size_t i) {
    reaches[i] = reach_of(scene, scene.instances[static_cast<uint32_t>(i)], to_axes, center, slope);
  });
  Reach reach;
  for (const Reach& one : reaches) reach.add(one);
  return reach;
}

}  // namespace

Mat4 framing_camera(const SceneView& scene, const Vec3& forward, const Vec2& tan_half, const Vec3& center) {
  const Vec3 right = glm::normalize(glm::cross(forward, Vec3(0, 1, 0)));
  const Vec3 up = glm::cross(right, forward);
  const Mat3 axes(right, up, -forward);
  const Mat3 to_axes = glm::transpose(axes);
  const Vec2 slope = kFramedShare * tan_half;
  Reach reach = reach_of(scene, to_axes, center, slope);

  Mat4 to_world(axes);
  Vec3 eye = center;
  if (is_finite(reach.nearest)) {
    const Vec2 needed = (reach.right + reach.left) / (2.0f * slope);
    // Leave room in front of an object that is long and thin along the view.
    const float least = reach.nearest + 1e-3f * (reach.nearest - reach.farthest);
    const float distance = std::max({needed.x, needed.y, least});
    // From there, the object fills less of the other dimension. Centre it there: use the centre of the narrower view
    // that it fills.
    constexpr int kSteps = 4;
    for (int i = 0; i < kSteps; ++i) {
      const Vec2 filled = (reach.right + reach.left) / (2.0f * distance);
      reach = reach_of(scene, to_axes, center, filled);
    }
    eye = center + axes * Vec3(0.5f * (reach.right - reach.left), distance);
  }
  to_world[3] = Vec4(eye, 1.0f);
  return to_world;
}

}  // namespace relume
