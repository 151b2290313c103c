// Tables of states for the cells around given points, for tests.
#pragma once

#include <vector>

#include "techniques/spatial/markov_grid/markov_grid.h"

namespace relume::testing {

template <typename ChainState>
struct FilledTable {
  MarkovGrid grid;
  std::vector<MarkovSlot<ChainState>> slots;

  explicit FilledTable(uint32_t adaptive_slots = 1u << 14, uint32_t static_slots = 1u << 12)
      : slots(size_t{adaptive_slots} + static_slots) {
    grid.keys.cone_spread = 0.01f;
    grid.keys.cell_size = 8;
    grid.static_level = -2;
    grid.adaptive_slots = adaptive_slots;
    grid.static_slots = static_slots;
    grid.seed = 1;
  }

  MarkovTable<ChainState> view() const { return {view_of(slots)}; }

  /// Sets the states of all cells that a vertex draws to state_of(number), where the number identifies the cell.
  template <typename StateOf>
  void fill(const SurfacePoint& sp, const StateOf& state_of) {
    const uint32_t seed = grid.seed_at(sp);
    for (uint32_t i = 0; i < grid.drawn_cells; ++i) {
      const MarkovCell cell = grid.drawn(sp, seed, i);
      slots[cell.slot] = {state_of(hash(cell.slot, cell.check)), cell.check};
    }
  }
};

/// A point at `position` with the normal `n`, at rest, without a BSDF.
inline SurfacePoint point_at(const Vec3& position, const Vec3& n) {
  SurfacePoint sp{};
  sp.position = sp.previous_position = position;
  sp.frame = make_frame(n);
  sp.ng = sp.ns = n;
  return sp;
}

}  // namespace relume::testing
