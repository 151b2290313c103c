#include "techniques/light_sampling/visibility_light_cache/exploration.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

/// Lower bound on squared distances to the camera, m²: the square of 1 % of the scene's radius.
float min_squared_distance(float scene_radius) { return sqr(0.01f * scene_radius); }

/// Hash of all inputs of the tables. `camera` and `scene_radius` determine a single table only.
uint64_t fingerprint_of(const LightsDigest& lights, const ExplorationWeights& weights, const UVec3& cells,
                        const Vec3& camera, float scene_radius) {
  uint64_t h = lights.hash + cells.x + (uint64_t{cells.y} << 20) + (uint64_t{cells.z} << 40);
  const auto add = [&h](float x) { h = (h ^ hash(float_bits(x))) * 0x9e3779b97f4a7c15u + (h >> 29); };
  for (const float w : {weights.energy, weights.change, weights.distance}) add(w);
  if (cells == UVec3(1)) {
    for (const float x : {camera.x, camera.y, camera.z, scene_radius}) add(x);
  }
  return h == 0 ? 1 : h;
}

/// Grid over `extent` of roughly cubic cells, at most `most`.
UVec3 grid_of(const Vec3& extent, uint32_t along_longest, uint32_t most) {
  for (uint32_t n = along_longest; n > 1; --n) {
    UVec3 cells;
    for (int axis = 0; axis < 3; ++axis) {
      const float share = extent[axis] / max_component(extent) * static_cast<float>(n);
      cells[axis] = std::max(static_cast<uint32_t>(std::ceil(share - 1e-3f)), 1u);
    }
    if (uint64_t{cells.x} * cells.y * cells.z <= most) return cells;
  }
  return UVec3(1);
}

}  // namespace

std::vector<LightSummary> light_summaries(const LightsView& lights, ChangeMeasure measure) {
  std::vector<LightSummary> list;
  for (LightId i = 0; i < lights.first_infinite; ++i) list.push_back(summary_of(lights, i, measure));
  return list;
}

std::vector<AliasEntry> build_exploration(const LightsView& lights, const Vec3& camera,
                                          const ExplorationWeights& weights) {
  const std::vector<LightSummary> summaries = light_summaries(lights);
  std::vector<AliasEntry> entries(summaries.size());
  std::vector<double> shares(summaries.size());
  std::vector<uint32_t> stack(summaries.size());
  uint32_t filled = 0;
  ExplorationTablesKernel kernel;
  kernel.lights = view_of(summaries);
  kernel.weights = weights;
  kernel.by_camera = true;
  kernel.camera = camera;
  kernel.min_distance2 = min_squared_distance(lights.bounds.radius);
  kernel.entries = mutable_view_of(entries);
  kernel.shares = mutable_view_of(shares);
  kernel.stack = mutable_view_of(stack);
  kernel.filled = {&filled, 1};
  kernel(0, 0);
  if (filled == 0) entries.clear();
  return entries;
}

void ExplorationTables::update_digest(Backend& backend, View<const LightSummary> summaries) {
  digest_ = reduce<CombineDigests>({backend, "vlc.exploration", scratch_}, DigestOfLight{summaries}, summaries.size);
}

void ExplorationTables::build(Backend& backend, View<const LightSummary> summaries, float scene_radius,
                              const Vec3& camera, const ExplorationWeights& weights, uint32_t cells) {
  constexpr uint32_t kMostEntries = 1u << 18;
  const Vec3 extent = digest_.high - digest_.low;
  const bool apart = digest_.emitting != 0 && max_component(extent) > 0.0f;
  const UVec3 dims = apart ? grid_of(extent, cells, kMostEntries / summaries.size) : UVec3(1);
  const uint64_t fingerprint = fingerprint_of(digest_, weights, dims, camera, scene_radius);
  if (fingerprint == fingerprint_) return;
  const uint32_t count = dims.x * dims.y * dims.z;
  ExplorationTablesKernel kernel;
  kernel.lights = summaries;
  kernel.weights = weights;
  kernel.by_camera = count == 1;
  kernel.camera = camera;
  kernel.min_distance2 = min_squared_distance(scene_radius);
  kernel.cells = dims;
  if (count > 1) {
    kernel.low = digest_.low;
    kernel.edge = extent / Vec3(dims);
    // The distance is at least half the diagonal of the cell.
    kernel.min_distance2 = 0.25f * length_squared(kernel.edge);
  }
  fingerprint_ = 0;  // until the tables are complete: allocation may fail
  const size_t size = size_t{count} * summaries.size;
  entries_.reset(size, kUninitialized);
  shares_.reset(size, kUninitialized);
  stack_.reset(size, kUninitialized);
  filled_.reset(count, kUninitialized);
  kernel.entries = entries_.mutable_view();
  kernel.shares = shares_.mutable_view();
  kernel.stack = stack_.mutable_view();
  kernel.filled = filled_.mutable_view();
  launch(backend, "vlc.exploration", kernel, count, 1, {}, 1);
  if (count == 1 && filled_.read()[0] == 0) entries_.clear();
  cells_ = dims;
  corner_ = kernel.low;
  for (int axis = 0; axis < 3; ++axis) scale_[axis] = kernel.edge[axis] > 0.0f ? 1.0f / kernel.edge[axis] : 0.0f;
  fingerprint_ = fingerprint;
}

ExplorationGrid ExplorationTables::grid() const { return {entries_.view(), corner_, scale_, cells_}; }

}  // namespace relume
