// How far the scene reaches.
#include <algorithm>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "scene/compiled_scene.h"
#include "scene/placement.h"

namespace relume {

void CompiledScene::Box::add(const Vec3& p) {
  low = glm::min(low, p);
  high = glm::max(high, p);
}

void CompiledScene::Box::add(const Box& box, const Mat4& to_world) {
  if (box.empty()) return;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                 corner & 4 ? box.high.z : box.low.z);
    add(transform_point(to_world, p));
  }
}

CompiledScene::Box CompiledScene::moving_box(const std::vector<Mat4>& world) const {
  Box box;
  for (size_t i = 0; i < appearances_.size(); ++i) {
    const Appearance& a = appearances_[i];
    if (!world_space_[i]) box.add(boxes_[mesh_of_appearance_[i]], world[a.node] * a.local);
  }
  return box;
}

void CompiledScene::check_extent(const Box& box) const {
  if (box.empty()) return;
  const float reach = std::max(max_component(abs(box.low)), max_component(abs(box.high)));
  if (!(reach <= kMaxCoordinate))
    throw Error(fmt::format("{}: the scene reaches {:g} m from the origin; scale it down to {:g} m at most",
                            source_.name, reach, kMaxCoordinate));
}

void CompiledScene::compute_bounds() {
  boxes_.assign(meshes_.size(), {});
  tbb::parallel_for(size_t{0}, meshes_.size(), [&](size_t m) {
    for (uint32_t t = 0; t < meshes_[m].triangle_count; ++t) {
      const UVec3 index = triangles_[meshes_[m].first_triangle + t];
      for (int k = 0; k < 3; ++k) boxes_[m].add(vertices_[index[k]].position);
    }
  });
  Box box = moving_box(world_);
  for (size_t i = 0; i < appearances_.size(); ++i) {
    if (world_space_[i]) box.add(boxes_[mesh_of_appearance_[i]], Mat4(1));
  }
  check_extent(box);
  if (box.empty()) box.add(Vec3(0));
  bounds_.center = 0.5f * (box.low + box.high);
  // A margin keeps rays from infinity outside whatever moves a little.
  bounds_.radius = std::max(0.55f * glm::length(box.high - box.low), 1e-3f);
}

}  // namespace relume
