#include "accel/refit_cost.h"

#include <algorithm>

#include "core/parallel.h"

namespace relume {
namespace {

constexpr size_t kClusterSize = 32;
constexpr float kMostGrowth = 1.5f;

float half_area(const Box& box) {
  if (box.empty()) return 0;
  const Vec3 d = box.extent();
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

Box triangle_box(const AccelMesh& mesh, uint32_t triangle) {
  Box box;
  for (size_t k = 0; k < 3; ++k) box.add(vertex_position(mesh, mesh.indices[size_t{3} * triangle + k]));
  return box;
}

/// Ten bits of a coordinate in [0, 1], with two zeros after each.
uint32_t spread_bits(float coordinate) {
  auto bits = static_cast<uint32_t>(coordinate > 0.0f ? std::min(coordinate, 1.0f) * 1023.0f : 0.0f);
  bits = (bits | bits << 16) & 0x030000ffu;
  bits = (bits | bits << 8) & 0x0300f00fu;
  bits = (bits | bits << 4) & 0x030c30c3u;
  return (bits | bits << 2) & 0x09249249u;
}

/// Morton code of a position in `box`: neighbours on this curve are mostly neighbours in space ([Morton66]).
uint32_t morton_code(const Vec3& p, const Box& box) {
  const Vec3 extent = glm::max(box.extent(), Vec3(1e-30f));
  const Vec3 relative = (p - box.low) / extent;
  return spread_bits(relative.x) << 2 | spread_bits(relative.y) << 1 | spread_bits(relative.z);
}

}  // namespace

RefitCost::RefitCost(const AccelMesh& mesh) {
  if (mesh.deforms) reset(mesh);
}

void RefitCost::reset(const AccelMesh& mesh) {
  Box whole;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) whole.add(triangle_box(mesh, t));
  struct Coded {
    uint32_t code;
    uint32_t triangle;
  };
  std::vector<Coded> coded(mesh.triangle_count);
  parallel_for(coded.size(), [&](size_t t) {
    const auto triangle = static_cast<uint32_t>(t);
    coded[t] = {morton_code(triangle_box(mesh, triangle).center(), whole), triangle};
  });
  std::sort(coded.begin(), coded.end(), [](const Coded& a, const Coded& b) {
    return a.code != b.code ? a.code < b.code : a.triangle < b.triangle;
  });
  order_.clear();
  for (const Coded& c : coded) order_.push_back(c.triangle);
  built_cost_ = cost(mesh);
}

float RefitCost::cost(const AccelMesh& mesh) const {
  const size_t clusters = (order_.size() + kClusterSize - 1) / kClusterSize;
  std::vector<Box> boxes(clusters);
  parallel_for(clusters, [&](size_t c) {
    const size_t end = std::min((c + 1) * kClusterSize, order_.size());
    for (size_t i = c * kClusterSize; i < end; ++i) boxes[c].add(triangle_box(mesh, order_[i]));
  });
  Box whole;
  float sum = 0;
  for (const Box& box : boxes) {
    whole.add(box);
    sum += half_area(box);
  }
  const float area = half_area(whole);
  return area > 0 ? sum / area : 0;
}

bool RefitCost::has_grown(const AccelMesh& mesh) const { return cost(mesh) > kMostGrowth * built_cost_; }

}  // namespace relume
