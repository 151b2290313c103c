// Exploration: light selection among all finite lights, including those that no cache lists yet. The probabilities are
// a mixture of three distributions: by power, over changed lights, by distance. There is one table for all points
// ([Dittebrandt20, §4.3]), or one per cell of a coarse grid.
#pragma once

#include <vector>

#include "core/array.h"
#include "core/hash.h"
#include "frame/primitives/reduce.h"
#include "lights/light.h"
#include "sampling/alias_table.h"
#include "techniques/light_sampling/visibility_light_cache/change_measure.h"

namespace relume {

/// Properties of a light for exploration.
struct LightSummary {
  Vec3 position{0};
  float watts = 0;   ///< luminance of the emitted power
  float change = 0;  ///< weight among the lights that have changed since the last frame
};

/// Watts that arrive differently than in the last frame: those gained or lost, and of the rest a share that grows with
/// the distance moved. A light that moved by `reach`, metres, counts half; other changes count a hundredth.
RELUME_HD inline float amount_of_change(const LightsView& lights, LightId id, float reach) {
  constexpr float kLeast = 0.01f;
  const float now = selection_weight(lights, id);
  if (id >= lights.previous.size) return now;
  LightsView before = lights;
  before.lights = lights.previous;
  const float earlier = selection_weight(before, id);
  const Vec3 step = position_of(lights.lights[id]) - position_of(lights.previous[id]);
  const float moved = std::sqrt(length_squared(step));
  const float share = moved > 0.0f ? moved / (moved + reach) : 0.0f;
  return std::fabs(now - earlier) + relume::max(now, earlier) * relume::max(share, kLeast);
}

/// Properties of a light.
RELUME_HD inline LightSummary summary_of(const LightsView& lights, LightId id, ChangeMeasure measure) {
  const Light& light = lights.lights[id];
  LightSummary summary{position_of(light), selection_weight(lights, id), 0.0f};
  if (light.changed)
    summary.change = measure == ChangeMeasure::flag ? 1.0f : amount_of_change(lights, id, 0.01f * lights.bounds.radius);
  return summary;
}

/// Properties of all finite lights, by id.
std::vector<LightSummary> light_summaries(const LightsView& lights, ChangeMeasure measure = ChangeMeasure::flag);

/// Writes the properties of each light.
struct LightSummariesKernel {
  LightsView lights;
  ChangeMeasure measure = ChangeMeasure::flag;
  View<LightSummary> summaries;

  RELUME_HD void operator()(uint32_t i, uint32_t) const { summaries[i] = summary_of(lights, i, measure); }
};

/// Bounds and hash of all lights; the hash detects changes.
struct LightsDigest {
  Vec3 low{kInfinity};  ///< bounds of the positions
  Vec3 high{-kInfinity};
  uint32_t emitting = 0;  ///< 1 if any light emits
  uint64_t hash = 0;      ///< of all summaries
};

/// Digest of each light; input of the reduction to a LightsDigest.
struct DigestOfLight {
  View<const LightSummary> summaries;

  RELUME_HD LightsDigest operator()(size_t i) const {
    const LightSummary& light = summaries.data[i];
    uint64_t h = i;
    const auto add = [&h](float x) { h = (h ^ hash(float_bits(x))) * 0x9e3779b97f4a7c15u + (h >> 29); };
    for (int axis = 0; axis < 3; ++axis) add(light.position[axis]);
    add(light.watts);
    add(light.change);
    return {light.position, light.position, light.watts > 0.0f ? 1u : 0u, h};
  }
};

/// Associative combination of two digests.
struct CombineDigests {
  using Value = LightsDigest;
  RELUME_HD static LightsDigest identity() { return {}; }
  RELUME_HD static LightsDigest combine(const LightsDigest& a, const LightsDigest& b) {
    return {glm::min(a.low, b.low), glm::max(a.high, b.high), a.emitting | b.emitting, a.hash + b.hash};
  }
};

/// Relative weights of the three distributions in the mixture.
struct ExplorationWeights {
  float energy = 1;  ///< by emitted power; > 0, so that every light can be chosen
  float change = 1;  ///< over the lights that changed since the last frame, by LightSummary::change
  /// By the inverse squared distance to the camera; in a grid, by power over squared distance to the cell.
  float distance = 1;
};

/// Alias tables over the finite lights, one per cell of a grid.
struct ExplorationGrid {
  View<const AliasEntry> entries;  ///< table by table, x fastest
  Vec3 corner{0};
  Vec3 scale{0};  ///< cells per metre
  UVec3 cells{1};

  RELUME_HD bool empty() const { return entries.empty(); }
  /// Points outside belong to the nearest cell.
  RELUME_HD AliasTable at(const Vec3& p) const {
    if (cells == UVec3(1)) return {entries};
    uint32_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const float x = (p[axis] - corner[axis]) * scale[axis];
      const float last = static_cast<float>(cells[axis] - 1);
      cell = cell * cells[axis] + static_cast<uint32_t>(relume::min(relume::max(x, 0.0f), last));
    }
    const uint32_t count = entries.size / (cells.x * cells.y * cells.z);
    return {{entries.data + cell * count, count}};
  }
};

/// Entries of an alias table over the finite lights. Lights without emission have probability 0. A distribution with no
/// lights is dropped; the other weights are renormalised.
std::vector<AliasEntry> build_exploration(const LightsView& lights, const Vec3& camera,
                                          const ExplorationWeights& weights);

/// Builds the table of each cell; one call per cell. A distribution without lights is dropped.
struct ExplorationTablesKernel {
  View<const LightSummary> lights;
  ExplorationWeights weights;
  bool by_camera = false;  ///< one table by distance to `camera`; otherwise by power over squared distance
  Vec3 camera{0};
  Vec3 low{0};   ///< low corner of the grid, metres
  Vec3 edge{0};  ///< of a cell, metres
  UVec3 cells{1};
  float min_distance2 = 0;  ///< lower bound on squared distances, m²
  View<AliasEntry> entries;
  View<double> shares;  ///< temporary, parallel to `entries`
  View<uint32_t> stack;
  View<uint32_t> filled;  ///< by cell: 0 if the sum of the weights is zero or not finite. The entries are then zero.

  RELUME_HD void operator()(uint32_t cell, uint32_t) const {
    const uint32_t first = cell * lights.size;
    const View<AliasEntry> table{entries.data + first, lights.size};
    blend(cell, table);
    const bool valid = fill_alias_table(table, {shares.data + first, lights.size}, {stack.data + first, lights.size});
    filled[cell] = valid ? 1 : 0;
    for (uint32_t i = 0; !valid && i < table.size; ++i) table[i] = {0.0f, 0, 0.0f};
  }

 private:
  /// Weight of a light that emits by distance to the camera, or to the middle of a cell.
  RELUME_HD float nearness(const LightSummary& light, const Vec3& middle) const {
    return by_camera ? 1.0f / relume::max(length_squared(light.position - camera), min_distance2)
                     : light.watts / relume::max(length_squared(light.position - middle), min_distance2);
  }

  /// Writes the weights of the mixture to `table`.
  RELUME_HD void blend(uint32_t cell, View<AliasEntry> table) const {
    const Vec3 at(static_cast<float>(cell % cells.x), static_cast<float>(cell / cells.x % cells.y),
                  static_cast<float>(cell / (cells.x * cells.y)));
    const Vec3 middle = low + edge * (at + Vec3(0.5f));
    double sums[3] = {0, 0, 0};
    for (uint32_t i = 0; i < lights.size; ++i) {
      const LightSummary& light = lights[i];
      if (!(light.watts > 0.0f)) continue;
      table[i].keep = nearness(light, middle);
      sums[0] += static_cast<double>(light.watts);
      sums[1] += static_cast<double>(light.change);
      sums[2] += static_cast<double>(table[i].keep);
    }
    const float mixture[3] = {weights.energy, weights.change, weights.distance};
    for (uint32_t i = 0; i < lights.size; ++i) {
      float weight = 0;
      if (lights[i].watts > 0.0f) {
        const float values[3] = {lights[i].watts, lights[i].change, table[i].keep};
        for (int d = 0; d < 3; ++d) {
          if (sums[d] > 0) weight += mixture[d] * static_cast<float>(static_cast<double>(values[d]) / sums[d]);
        }
      }
      table[i].pmf = weight;
    }
  }
};

/// Owns the tables of a grid over the box of the finite lights.
class ExplorationTables {
 public:
  explicit ExplorationTables(Memory& memory) : entries_(memory), shares_(memory), stack_(memory), filled_(memory) {}

  /// Call before build() when lights may have changed. `summaries`: light_summaries(lights).
  void update_digest(Backend& backend, View<const LightSummary> summaries);
  /// Rebuilds the tables where an input changed, for the lights of the last update_digest(). `cells`: along the longest
  /// side, reduced for very many lights; 1: a single table by distance to the camera, as in the paper. `scene_radius`:
  /// metres.
  void build(Backend& backend, View<const LightSummary> summaries, float scene_radius, const Vec3& camera,
             const ExplorationWeights& weights, uint32_t cells);
  ExplorationGrid grid() const;
  size_t memory_bytes() const {
    return entries_.memory_bytes() + shares_.memory_bytes() + stack_.memory_bytes() + filled_.memory_bytes() +
           scratch_.memory_bytes();
  }

 private:
  Array<AliasEntry> entries_;
  Array<double> shares_;
  Array<uint32_t> stack_;
  Array<uint32_t> filled_;
  PrimitiveScratch scratch_;
  LightsDigest digest_;
  Vec3 corner_{0};
  Vec3 scale_{0};
  UVec3 cells_{1};
  uint64_t fingerprint_ = 0;  ///< hash of all inputs of the tables; 0: no tables kept
};

}  // namespace relume
