// Passes over the table after the paths of a frame: histories take in what it has added, cells that nobody has used for
// long are emptied, and what is left moves to a table of another size when that pays.
#pragma once

#include "frame/launch.h"
#include "techniques/spatial/hash_grid/hash_grid.h"

namespace relume {

/// What the passes have counted.
struct HashGridCensus {
  uint64_t taken = 0;          ///< slots with a key
  uint64_t live = 0;           ///< cells with samples
  uint64_t evicted = 0;        ///< cells emptied in this pass
  uint64_t samples = 0;        ///< added in the frame
  uint64_t changed = 0;        ///< cells in regions that have changed
  uint64_t displacements = 0;  ///< distance of the cells from their first slots, summed
};

/// Slots side by side in the grid over which the passes run.
inline constexpr uint32_t kMaintenanceRow = 16;

/// Gives new cells what they take over from another level; one call a slot. Reads no cell that it writes.
struct InheritCellsKernel {
  HashGridView grid;
  View<CellHistory> histories;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t slot = y * kMaintenanceRow + x;
    if (slot >= grid.parents.size || grid.parents[slot] == kNoCell) return;
    histories[slot].moments = grid.inherited(slot);
    grid.parents[slot] = kNoCell;
  }
};

/// Compares what cells have gathered with what they remember, for each region; one call a slot.
struct MeasureChangesKernel {
  HashGridView grid;
  View<RegionChange> regions;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t slot = y * kMaintenanceRow + x;
    if (slot >= grid.fingerprints.size || grid.fingerprints[slot] == 0 || grid.sums[slot].empty()) return;
    const CellHistory& history = grid.histories[slot];
    if (history.moments.count < grid.rule.min_count) return;
    const CellMoments window = pooled(history.recent, grid.sums[slot].moments(), kInfinity);
    if (window.count < grid.rule.min_count) return;
    regions[region_of(grid.bucket_hashes[slot])].add(squared_departure(history.moments, window));
  }
};

/// Averages and evicts; one call a slot.
struct MaintainCellsKernel {
  HashGridView grid;
  View<CellHistory> histories;
  View<const RegionChange> regions;  ///< empty: nothing is known of changes
  HashGridCensus* census = nullptr;
  uint32_t max_age = 0;  ///< frames without samples after which a cell is emptied

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    HashGridCensus part;
    treat(y * kMaintenanceRow + x, part);
    add(part);
  }

  void operator()(const Tile& tile) const {
    HashGridCensus part;
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) treat(y * kMaintenanceRow + x, part);
    }
    add(part);
  }

 private:
  RELUME_HD void treat(uint32_t slot, HashGridCensus& part) const {
    if (slot >= grid.fingerprints.size || grid.fingerprints[slot] == 0) return;
    part.displacements += grid.displacement({grid.fingerprints[slot], grid.bucket_hashes[slot]}, slot);
    ++part.taken;
    CellSums& sums = grid.sums[slot];
    CellHistory& history = histories[slot];
    if (!sums.empty()) {
      part.samples += sums.count;
      const float excess =
          regions.empty()
              ? 0.0f
              : regions[region_of(grid.bucket_hashes[slot])].excess(kRegionThreshold * grid.rule.change_threshold);
      part.changed += excess > 0.0f ? 1u : 0u;
      history = advanced(history, sums.moments(), grid.rule, excess);
      sums = {};
    } else if (!history.empty() && ++history.age > max_age) {
      history = {};
      ++part.evicted;
    }
    part.live += history.empty() ? 0u : 1u;
  }

  RELUME_HD void add(const HashGridCensus& part) const {
    if (part.taken == 0) return;
    atomic_add(&census->taken, part.taken);
    atomic_add(&census->live, part.live);
    atomic_add(&census->evicted, part.evicted);
    atomic_add(&census->samples, part.samples);
    atomic_add(&census->changed, part.changed);
    atomic_add(&census->displacements, part.displacements);
  }
};

/// Copies the cells of one table that hold anything into another, empty one; one call a slot of the source.
struct MoveCellsKernel {
  View<const uint64_t> fingerprints;
  View<const uint32_t> bucket_hashes;
  View<const CellSums> sums;
  View<const CellHistory> source;
  HashGridView target;
  View<CellHistory> histories;  ///< of the target
  uint32_t* longest = nullptr;  ///< largest number of slots between a cell and its first slot

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t from = y * kMaintenanceRow + x;
    if (from >= fingerprints.size || (source[from].empty() && sums[from].empty())) return;
    const CellAddress address{fingerprints[from], bucket_hashes[from]};
    const uint32_t to = target.find_or_insert(address);
    histories[to] = source[from];
    target.sums[to] = sums[from];
    atomic_max(longest, target.displacement(address, to));
  }
};

/// Takes the links to parents along, when MoveCellsKernel is through; one call a slot of the source.
struct MoveParentsKernel {
  View<const uint64_t> fingerprints;
  View<const uint32_t> bucket_hashes;
  View<const uint32_t> parents;
  HashGridView target;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t from = y * kMaintenanceRow + x;
    if (from >= parents.size || parents[from] == kNoCell) return;
    const uint32_t parent = parents[from];
    const uint32_t to = target.find({fingerprints[from], bucket_hashes[from]});
    target.parents[to] = target.find({fingerprints[parent], bucket_hashes[parent]});
  }
};

/// Adds the samples that wait to their cells; one call a sample.
struct AddWaitingSamplesKernel {
  View<const WaitingSample> samples;
  HashGridView grid;
  uint32_t* longest = nullptr;  ///< as for MoveCellsKernel

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = y * kMaintenanceRow + x;
    if (i >= samples.size) return;
    const CellAddress address = grid.keys.address(samples[i].point, samples[i].coarser);
    const uint32_t slot = grid.find_or_insert(address);
    if (slot != kNoCell) atomic_max(longest, grid.displacement(address, slot));
    grid.add(samples[i], slot);
  }
};

}  // namespace relume
