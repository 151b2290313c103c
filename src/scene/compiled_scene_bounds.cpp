// Bounds of the scene.
#include <algorithm>

#include <fmt/format.h>

#include "core/parallel.h"
#include "relume/error.h"
#include "scene/compiled_scene.h"
#include "scene/placement.h"

namespace relume {

namespace {

/// Times at which to evaluate animated bounds: the keys, at most several thousand, and times between them where keys
/// are few. Includes 0.
std::vector<float> times_of_animation(const Scene& scene) {
  constexpr size_t kMostKeys = 4096;
  constexpr size_t kMostStretches = 64;  // intervals sampled between their ends
  constexpr int kBetween = 4;            // rotations bulge between keys
  std::vector<float> keys{0};
  for (const AnimationChannel& channel : scene.animation)
    keys.insert(keys.end(), channel.times.begin(), channel.times.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<float> times;
  const auto rounded_up = [](size_t a, size_t b) { return (a + b - 1) / b; };
  for (size_t i = 0; i < keys.size(); i += rounded_up(keys.size(), kMostKeys)) times.push_back(keys[i]);
  times.push_back(keys.back());
  const size_t stretch = rounded_up(keys.size(), kMostStretches);
  for (size_t i = 0; i + 1 < keys.size(); i += stretch) {
    const float next = keys[std::min(i + stretch, keys.size() - 1)];
    for (int k = 1; k < kBetween; ++k) times.push_back(lerp(keys[i], next, static_cast<float>(k) / kBetween));
  }
  return times;
}

}  // namespace

Box CompiledScene::placed_box(const std::vector<Mat4>& world, bool moving_only) const {
  Box box;
  const JointMatrices joints = deforming_.size() > 0 ? joint_matrices(source_, world) : JointMatrices();
  for (size_t i = 0; i < mesh_instances_.size(); ++i) {
    const MeshInstance& a = mesh_instances_[i];
    if (a.deforming != kNoHit) {
      const Box reach = deforming_.box(a.deforming, joints);
      box.add(a.skinned ? reach : transformed(reach, world[a.node] * a.local));
      continue;
    }
    if (!world_space_[i] && (moves_[a.node] || !moving_only))
      box.add(transformed(boxes_[mesh_of_instance_[i]], world[a.node] * a.local));
  }
  return box;
}

void CompiledScene::check_extent(const Box& box) const {
  if (box.empty()) return;
  const float reach = std::max(max_component(abs(box.low)), max_component(abs(box.high)));
  if (!(reach <= kMaxCoordinate))
    throw Error(fmt::format("{}: the scene reaches {:g} m from the origin; scale it down to {:g} m at most",
                            error_place(source_), reach, kMaxCoordinate));
}

Box CompiledScene::box_of(const MeshView& mesh) const {
  const std::span<const Vertex> vertices = vertices_.read();
  const std::span<const UVec3> triangles = triangles_.read();
  Box box;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const UVec3 index = triangles[mesh.first_triangle + t];
    for (int k = 0; k < 3; ++k) box.add(vertices[index[k]].position);
  }
  return box;
}

void CompiledScene::compute_bounds() {
  const std::span<const MeshView> meshes = meshes_.read();
  boxes_.assign(meshes.size(), {});
  parallel_for(meshes.size(), [&](size_t m) { boxes_[m] = box_of(meshes[m]); });
  for (size_t i = 0; i < mesh_instances_.size(); ++i) {
    if (world_space_[i]) extent_.add(boxes_[mesh_of_instance_[i]]);
  }
  // Independent of the start time, so frames do not depend on earlier ones.
  extent_.add(placed_box(world_matrices(source_, 0)));
  const bool anything_moves = std::any_of(mesh_instances_.begin(), mesh_instances_.end(), [&](const MeshInstance& a) {
    return moves_[a.node] || a.deforming != kNoHit;
  });
  if (anything_moves) {
    for (const float time_s : times_of_animation(source_))
      extent_.add(placed_box(world_matrices(source_, time_s), true));
  }
  check_extent(extent_);
  set_bounds();
}

void CompiledScene::set_bounds() {
  if (extent_.empty()) extent_.add(Vec3(0));
  bounds_.center = extent_.center();
  // The margin covers motion between the sampled times, so rays from infinity start outside.
  bounds_.radius = std::max(0.55f * extent_.diagonal(), 1e-3f);
}

}  // namespace relume
