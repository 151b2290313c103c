// Passes over the table after the paths of a frame. They pool sums with histories, empty cells that were unused for
// long, and move cells to a table of another size. A slot is a bounded amount of work on one cell, so it needs no group
// of threads.
#pragma once

#include "frame/launch.h"
#include "techniques/spatial/hash_grid/hash_grid.h"

namespace relume {

/// Counts of the passes.
struct HashGridCensus {
  uint64_t taken = 0;          ///< slots with a key
  uint64_t live = 0;           ///< cells with samples
  uint64_t evicted = 0;        ///< cells emptied in this pass
  uint64_t samples = 0;        ///< samples added in the frame
  uint64_t changed = 0;        ///< cells in changed regions
  uint64_t displacements = 0;  ///< sum of the distances of cells from their first slots
};

/// Width of the launches, in slots.
inline constexpr uint32_t kMaintenanceRow = 16;

/// Copies inherited moments to new cells; one call per slot. Reads no cell that it writes.
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

/// Sums the squared departures of windows from histories per region; one call per slot.
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

/// Pools sums with histories and evicts old cells; one call per slot.
struct MaintainCellsKernel {
  HashGridView grid;
  View<CellHistory> histories;
  View<const RegionChange> regions;  ///< results of MeasureChangesKernel; empty: regions are not tested
  View<HashGridCensus> census;       ///< one element
  uint32_t max_age = 0;              ///< maximum number of frames without samples

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
    atomic_add(&census[0].taken, part.taken);
    atomic_add(&census[0].live, part.live);
    atomic_add(&census[0].evicted, part.evicted);
    atomic_add(&census[0].samples, part.samples);
    atomic_add(&census[0].changed, part.changed);
    atomic_add(&census[0].displacements, part.displacements);
  }
};

/// Copies all cells with samples to an empty table; one call per slot of the source.
struct MoveCellsKernel {
  View<const uint64_t> fingerprints;
  View<const uint32_t> bucket_hashes;
  View<const CellSums> sums;
  View<const CellHistory> source;
  HashGridView target;
  View<CellHistory> histories;  ///< histories of the target
  View<uint32_t> longest;       ///< one element: largest displacement of a cell

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t from = y * kMaintenanceRow + x;
    if (from >= fingerprints.size || (source[from].empty() && sums[from].empty())) return;
    const CellAddress address{fingerprints[from], bucket_hashes[from]};
    const uint32_t to = target.find_or_insert(address);
    histories[to] = source[from];
    target.sums[to] = sums[from];
    atomic_max(&longest[0], target.displacement(address, to));
  }
};

/// Copies the links to parents after MoveCellsKernel; one call per slot of the source.
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

/// Adds waiting samples to their cells; one call per sample.
struct AddWaitingSamplesKernel {
  View<const WaitingSample> samples;
  HashGridView grid;
  View<uint32_t> longest;  ///< as for MoveCellsKernel

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = y * kMaintenanceRow + x;
    if (i >= samples.size) return;
    const CellAddress address = grid.keys.address(samples[i].point, samples[i].coarser);
    const uint32_t slot = grid.find_or_insert(address);
    if (slot != kNoCell) atomic_max(&longest[0], grid.displacement(address, slot));
    grid.add(samples[i], slot);
  }
};

}  // namespace relume
