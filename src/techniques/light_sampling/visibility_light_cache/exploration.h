// Exploration: light selection among all finite lights, including those that no cache lists yet. The probabilities are
// a mixture of three distributions: by power, over changed lights, by distance. There is one table for all points
// ([Dittebrandt20, §4.3]), or one per cell of a coarse grid.
#pragma once

#include <vector>

#include "core/array.h"
#include "lights/light.h"
#include "sampling/alias_table.h"

namespace relume {

/// Properties of a light for exploration.
struct LightSummary {
  Vec3 position{0};
  float watts = 0;  ///< luminance of the emitted power
  bool changed = false;
};

/// Properties of all finite lights, by id.
std::vector<LightSummary> light_summaries(const LightsView& lights);

/// Relative weights of the three distributions in the mixture.
struct ExplorationWeights {
  float energy = 1;  ///< by emitted power; > 0, so that every light can be chosen
  float change = 1;  ///< uniform over the lights that changed since the last frame
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

/// Owns the tables of a grid over the box of the finite lights.
class ExplorationTables {
 public:
  explicit ExplorationTables(Memory& memory = host_memory()) : entries_(memory) {}

  /// `summaries`: light_summaries(lights). `cells`: along the longest side, reduced for very many lights; 1: a single
  /// table by distance to the camera, as in the paper. The tables of several cells are rebuilt only when a light
  /// changes.
  void build(const LightsView& lights, const std::vector<LightSummary>& summaries, const Vec3& camera,
             const ExplorationWeights& weights, uint32_t cells);
  ExplorationGrid grid() const;
  size_t memory_bytes() const { return entries_.memory_bytes(); }

 private:
  Array<AliasEntry> entries_;
  Vec3 corner_{0};
  Vec3 scale_{0};
  UVec3 cells_{1};
  uint64_t fingerprint_ = 0;  ///< hash of all inputs of the tables; 0: no tables kept
};

}  // namespace relume
