// Hashed grids whose cells each hold the state of one Markov chain ([Alber25]). Paths draw several cells at random at
// each vertex. Edges of cells of the adaptive grid cover about a fixed number of pixels. Cells of the static grid have
// one size in metres.
#pragma once

#include "core/hash.h"
#include "scene/surface_point.h"
#include "techniques/spatial/hash_grid/cell_key.h"

namespace relume {

inline constexpr uint32_t kNoSlot = 0xffffffffu;

/// Maximum number of cells drawn at a vertex, and of recorded vertices per path.
inline constexpr uint32_t kMostDrawnCells = 6;
inline constexpr uint32_t kMostChainVertices = 4;

/// Place of a cell in the table, and a number that distinguishes it from other cells with the same slot.
struct MarkovCell {
  uint32_t slot = kNoSlot;  ///< kNoSlot: no cell
  uint32_t check = 0;
};

struct MarkovGrid {
  // Numbers of the hashes from which a cell is drawn.
  static constexpr uint32_t kKindNumber = 1;
  static constexpr uint32_t kLevelNumber = 2;
  static constexpr uint32_t kJitterNumber = 3;

  static constexpr int kMostRaisedLevels = 8;
  static constexpr int kNormalSteps = 1;  ///< of a normal's component in [0, 1]: each has three values

  CellKeys keys;                ///< edges of the adaptive cells
  int static_level = 0;         ///< static cells have edges of 2^static_level metres
  uint32_t adaptive_slots = 0;  ///< first slots of the table
  uint32_t static_slots = 0;    ///< slots after those
  float adaptive_share = 0.7f;  ///< probability of the adaptive grid
  uint32_t drawn_cells = 5;     ///< at most kMostDrawnCells
  uint32_t seed = 0;            ///< different in each frame

  /// Seed of the cells drawn at a vertex. It depends on the place and the frame alone, so all calls at a vertex see the
  /// same cells, and densities describe the samples.
  RELUME_HD uint32_t seed_at(const SurfacePoint& sp) const {
    const Vec3& p = sp.position;
    return hash(hash(seed, float_bits(p.x)), float_bits(p.y), float_bits(p.z));
  }

  RELUME_HD bool is_static(const MarkovCell& cell) const { return cell.slot >= adaptive_slots; }

  /// Cell i of those drawn at a vertex, for reading: where its material point was when the cells were written.
  RELUME_HD MarkovCell drawn(const SurfacePoint& sp, uint32_t vertex_seed, uint32_t i) const {
    const uint32_t h = hash(vertex_seed, i);
    return to_unit_float(hash(h, kKindNumber)) < adaptive_share ? adaptive_cell(sp.previous_position, sp.ng, h)
                                                                : static_cell(sp.previous_position, h);
  }

  /// A cell of the adaptive grid around `p`, by the random number `h`. Its edge is twice as long with probability 1/2,
  /// four times with 1/4, and so on. The position is moved at random by up to half an edge.
  RELUME_HD MarkovCell adaptive_cell(const Vec3& p, const Vec3& normal, uint32_t h) const {
    const uint32_t bits = hash(h, kLevelNumber);
    int level = keys.level_of_detail(p);
    for (int i = 0; i < kMostRaisedLevels && (bits >> i & 1u) != 0; ++i) ++level;
    CellPoint point;
    point.normal = CellKeys::bins(normal, kNormalSteps);
    return cell_at(jittered(p, level, h), point, level, 0, adaptive_slots);
  }

  /// A cell of the static grid around `p`, moved in the same way. It does not distinguish normals.
  RELUME_HD MarkovCell static_cell(const Vec3& p, uint32_t h) const {
    CellPoint point;
    point.layer = 1;
    return cell_at(jittered(p, static_level, h), point, static_level, adaptive_slots, static_slots);
  }

  /// Edge of the smallest adaptive cell at `p`, metres.
  RELUME_HD float edge_at(const Vec3& p) const { return power_of_two(keys.level_of_detail(p)); }

 private:
  RELUME_HD static glm::dvec3 jittered(const Vec3& p, int level, uint32_t h) {
    const double edge = wide_power_of_two(level);
    glm::dvec3 moved(p);
    for (int c = 0; c < 3; ++c) {
      moved[c] += edge * (static_cast<double>(to_unit_float(hash(h, kJitterNumber + static_cast<uint32_t>(c)))) - 0.5);
    }
    return moved;
  }

  RELUME_HD MarkovCell cell_at(const glm::dvec3& p, const CellPoint& point, int level, uint32_t first,
                               uint32_t slots) const {
    const uint64_t fingerprint = keys.address_at(p, point, level, 0).fingerprint;
    const uint64_t place = (fingerprint & 0xffffffffu) * slots;
    return {first + static_cast<uint32_t>(place >> 32), static_cast<uint32_t>(fingerprint >> 32)};
  }
};

/// Element of a table: the state of the cell that wrote it last. A state has the member `weight`, 0 for none.
template <typename ChainState>
struct MarkovSlot {
  ChainState state;
  uint32_t check = 0;
};

/// The table that paths read: states of earlier frames.
template <typename ChainState>
struct MarkovTable {
  View<const MarkovSlot<ChainState>> slots;

  /// State of the cell; an empty one if another cell has its slot.
  RELUME_HD ChainState load(const MarkovCell& cell) const {
    if (cell.slot >= slots.size || slots[cell.slot].check != cell.check) return {};
    return slots[cell.slot].state;
  }
};

}  // namespace relume
