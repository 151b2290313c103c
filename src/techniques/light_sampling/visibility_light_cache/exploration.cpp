#include "techniques/light_sampling/visibility_light_cache/exploration.h"

#include <algorithm>
#include <cmath>

#include "core/hash.h"
#include "core/parallel.h"

namespace relume {
namespace {

/// Weights for an alias table; `near(light)` is the weight by distance.
template <typename Near>
std::vector<float> blend(const std::vector<LightSummary>& lights, const ExplorationWeights& weights, const Near& near) {
  std::vector<float> distributions[3];
  for (std::vector<float>& distribution : distributions) distribution.assign(lights.size(), 0.0f);
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!(lights[i].watts > 0.0f)) continue;
    distributions[0][i] = lights[i].watts;
    distributions[1][i] = lights[i].changed ? 1.0f : 0.0f;
    distributions[2][i] = near(lights[i]);
  }
  const float shares[3] = {weights.energy, weights.change, weights.distance};
  std::vector<float> blended(lights.size(), 0.0f);
  for (int d = 0; d < 3; ++d) {
    double sum = 0;
    for (const float w : distributions[d]) sum += static_cast<double>(w);
    if (!(sum > 0)) continue;
    for (size_t i = 0; i < lights.size(); ++i)
      blended[i] += shares[d] * static_cast<float>(static_cast<double>(distributions[d][i]) / sum);
  }
  return blended;
}

/// By distance to the camera, at least 1 % of the scene's radius.
std::vector<AliasEntry> one_table(const std::vector<LightSummary>& lights, float scene_radius, const Vec3& camera,
                                  const ExplorationWeights& weights) {
  const float nearest2 = sqr(0.01f * scene_radius);
  return build_alias_table(blend(lights, weights, [&](const LightSummary& light) {
    return 1.0f / std::max(length_squared(light.position - camera), nearest2);
  }));
}

uint64_t fingerprint_of(const std::vector<LightSummary>& lights, const ExplorationWeights& weights, uint32_t cells) {
  uint64_t h = cells + 1;
  const auto add = [&h](float x) { h = (h ^ hash(float_bits(x))) * 0x9e3779b97f4a7c15u + (h >> 29); };
  for (const float w : {weights.energy, weights.change, weights.distance}) add(w);
  for (const LightSummary& light : lights) {
    for (int axis = 0; axis < 3; ++axis) add(light.position[axis]);
    add(light.watts);
    add(light.changed ? 1.0f : 0.0f);
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

std::vector<LightSummary> light_summaries(const LightsView& lights) {
  std::vector<LightSummary> list(lights.first_infinite);
  for (LightId i = 0; i < lights.first_infinite; ++i)
    list[i] = {position_of(lights.lights[i]), selection_weight(lights, i), lights.lights[i].changed};
  return list;
}

std::vector<AliasEntry> build_exploration(const LightsView& lights, const Vec3& camera,
                                          const ExplorationWeights& weights) {
  return one_table(light_summaries(lights), lights.bounds.radius, camera, weights);
}

void ExplorationTables::build(const LightsView& lights, const std::vector<LightSummary>& list, const Vec3& camera,
                              const ExplorationWeights& weights, uint32_t cells) {
  Vec3 low(kInfinity);
  Vec3 high(-kInfinity);
  for (const LightSummary& light : list) {
    low = glm::min(low, light.position);
    high = glm::max(high, light.position);
  }
  constexpr uint32_t kMostEntries = 1u << 18;
  const bool emits =
      std::any_of(list.begin(), list.end(), [](const LightSummary& light) { return light.watts > 0.0f; });
  const bool apart = emits && max_component(high - low) > 0.0f;
  const UVec3 dims = apart ? grid_of(high - low, cells, kMostEntries / static_cast<uint32_t>(list.size())) : UVec3(1);
  const uint32_t count = dims.x * dims.y * dims.z;
  if (count == 1) {
    entries_.assign(one_table(list, lights.bounds.radius, camera, weights));
    cells_ = UVec3(1);
    fingerprint_ = 0;
    return;
  }
  const uint64_t fingerprint = fingerprint_of(list, weights, cells);
  if (fingerprint == fingerprint_) return;
  fingerprint_ = fingerprint;
  cells_ = dims;
  corner_ = low;
  const Vec3 edge = (high - low) / Vec3(dims);
  for (int axis = 0; axis < 3; ++axis) scale_[axis] = edge[axis] > 0.0f ? 1.0f / edge[axis] : 0.0f;
  // The distance is at least half the diagonal of the cell.
  const float nearest2 = 0.25f * length_squared(edge);
  entries_.reset(size_t{count} * list.size());
  const std::span<AliasEntry> entries = entries_.write();
  parallel_for(count, [&](uint32_t cell) {
    const Vec3 at(cell % dims.x, cell / dims.x % dims.y, cell / (dims.x * dims.y));
    const Vec3 middle = low + edge * (at + Vec3(0.5f));
    const std::vector<AliasEntry> table = build_alias_table(blend(list, weights, [&](const LightSummary& light) {
      return light.watts / std::max(length_squared(light.position - middle), nearest2);
    }));
    std::copy(table.begin(), table.end(), entries.begin() + static_cast<std::ptrdiff_t>(cell * list.size()));
  });
}

ExplorationGrid ExplorationTables::grid() const { return {entries_.view(), corner_, scale_, cells_}; }

}  // namespace relume
