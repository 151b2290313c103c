// Among all lights, for exploration: a blend of guesses that know nothing of the point ([Dittebrandt20, §4.3]), or only
// the cell of a coarse grid in which it lies.
#pragma once

#include <vector>

#include "lights/light.h"
#include "sampling/alias_table.h"

namespace relume {

/// What is known of a light without knowing the point that it shines on.
struct LightGuess {
  Vec3 position{0};
  float watts = 0;  ///< luminance of the emitted power
  bool changed = false;
};

/// Of all finite lights, by id.
std::vector<LightGuess> light_guesses(const LightsView& lights);

/// Shares of the three in the blend, up to their sum.
struct ExplorationWeights {
  float energy = 1;  ///< by emitted power; > 0, so that every light has its chance
  float change = 1;  ///< lights that changed since the last frame, each alike
  /// By the inverse square of the distance to the camera; in a grid, by power over that to the cell.
  float distance = 1;
};

/// Alias tables over the finite lights for the cells of a grid; one table if there is one cell.
struct ExplorationGrid {
  View<const AliasEntry> entries;  ///< table by table, x fastest
  Vec3 corner{0};
  Vec3 scale{0};  ///< cells a metre
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

/// Entries of an alias table over the finite lights. Lights that emit nothing are never chosen; guesses that know no
/// light leave their share to the others.
std::vector<AliasEntry> build_exploration(const LightsView& lights, const Vec3& camera,
                                          const ExplorationWeights& weights);

/// Owns the tables of a grid over the box of the finite lights.
class ExplorationTables {
 public:
  /// `cells` along the longest side, fewer where there are very many lights; 1: a single table that goes by the
  /// distance to the camera, as the paper has it. Tables of several cells are kept while no light changes.
  /// `guesses`: light_guesses(lights).
  void build(const LightsView& lights, const std::vector<LightGuess>& guesses, const Vec3& camera,
             const ExplorationWeights& weights, uint32_t cells);
  ExplorationGrid grid() const;
  size_t memory_bytes() const { return sizeof(AliasEntry) * entries_.size(); }

 private:
  std::vector<AliasEntry> entries_;
  Vec3 corner_{0};
  Vec3 scale_{0};
  UVec3 cells_{1};
  uint64_t fingerprint_ = 0;  ///< of all that the tables depend on; 0: none are kept
};

}  // namespace relume
