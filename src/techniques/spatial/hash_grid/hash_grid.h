// The hash grid: an open-addressing table of cells that kernels fill and read at the same time ([Binder19], §3.2).
// Samples of the running frame are added to integer sums. Kernels read moments, which a pass between frames computes
// from the sums. No value that a kernel reads therefore depends on other threads ([Schipek22 §5.3], double buffering).
#pragma once

#include "core/view.h"
#include "techniques/spatial/hash_grid/cell.h"
#include "techniques/spatial/hash_grid/cell_key.h"
#include "techniques/spatial/hash_grid/overflow.h"

namespace relume {

/// No slot: the cell is not in the table.
inline constexpr uint32_t kNoCell = 0xffffffffu;

/// Maximum number of slots probed for a key. If none is free, its samples wait until the table has grown.
inline constexpr uint32_t kMaxProbes = 256;

/// Slots among which the cells of one voxel start probing; a power of two.
inline constexpr uint32_t kBucketSlots = 64;

/// Counts of events for statistics.
struct HashGridCounters {
  uint64_t dropped = 0;           ///< samples dropped for lack of memory
  uint64_t saturated = 0;         ///< samples clamped to kCellSampleMax
  uint64_t nonfinite = 0;         ///< rejected samples that were not finite
  uint64_t made = 0;              ///< keys inserted in this frame
  uint64_t inherited_cells = 0;   ///< new cells of this frame that inherit moments from another level
  uint64_t skipped_vertices = 0;  ///< vertices of paths without a sample, behind too many waiting ones
};

/// Most coarser levels with which an undersampled cell is pooled, and a sample's probability to be added one level
/// higher. A level has eight cells of the finer one in a volume, four on a surface.
inline constexpr int kCoarserLevels = 3;
inline constexpr float kCoarserProbability = 0.125f;
inline constexpr float kCoarserProbabilityWithNeighbours = 0.5f;

struct HashGridView {
  View<uint64_t> fingerprints;   ///< 0: free
  View<uint32_t> bucket_hashes;  ///< bucket hash by slot, for moving cells to another table
  View<uint32_t> parents;        ///< slot of the cell from which a new one inherits, or kNoCell
  View<CellSums> sums;           ///< sums of this frame
  View<const CellHistory> histories;
  View<HashGridCounters> counters;  ///< one element
  OverflowView overflow;
  uint32_t probe_limit = kMaxProbes;  ///< maximum number of slots probed for a key
  bool renumbered = false;            ///< whether the table was rebuilt since the paths of this frame
  CellKeys keys;
  AveragingRule rule;
  UndersampledCells undersampled_cells = UndersampledCells::coarser;
  int coarser_levels = kCoarserLevels;              ///< coarser levels that receive samples and are pooled
  float coarser_probability = kCoarserProbability;  ///< probability of a sample to be added one level higher
  float inherited_count = 0;                        ///< maximum number of samples that a new cell inherits; 0: none
  float clamp_factor = 0;  ///< multiple of the cell's mean to which samples are clamped; 0: no clamping

  RELUME_HD uint32_t slot_of(uint32_t bucket_hash) const {
    return static_cast<uint32_t>((static_cast<uint64_t>(bucket_hash) * fingerprints.size) >> 32);
  }

  /// The slot where probing begins. Cells of one voxel have the same bucket hash but begin at different slots nearby.
  /// Curved and bumpy surfaces have many cells per voxel. From one slot, each would be probed past all the others.
  RELUME_HD uint32_t first_slot(const CellAddress& address) const {
    const uint32_t slot =
        slot_of(address.bucket_hash) + (static_cast<uint32_t>(address.fingerprint) & (kBucketSlots - 1));
    return slot < fingerprints.size ? slot : slot % fingerprints.size;
  }

  /// Number of slots from the first slot of a key to `slot`, which holds it.
  RELUME_HD uint32_t displacement(const CellAddress& address, uint32_t slot) const {
    const uint32_t first = first_slot(address);
    return slot >= first ? slot - first : slot + fingerprints.size - first;
  }

  /// Prefetch a cell that will soon be read or added to. It is rarely in cache, and atomic additions would stall.
  RELUME_HD void prefetch_moments(const CellAddress& address) const {
    const uint32_t slot = first_slot(address);
    prefetch(&fingerprints[slot]);
    prefetch(&histories[slot].moments);
  }
  RELUME_HD void prefetch_sums(const CellAddress& address) const {
    const uint32_t slot = first_slot(address);
    prefetch(&fingerprints[slot]);
    prefetch(&sums[slot]);
  }

  /// Slot of a cell, or kNoCell if it is not in the table.
  RELUME_HD uint32_t find(const CellAddress& address) const {
    uint32_t slot = first_slot(address);
    for (uint32_t i = 0; i < probe_limit; ++i) {
      const uint64_t found = atomic_load(&fingerprints[slot]);
      if (found == address.fingerprint) return slot;
      if (found == 0) return kNoCell;
      slot = slot + 1 == fingerprints.size ? 0 : slot + 1;
    }
    return kNoCell;
  }

  /// Slot of the cell of `p`. `noted`: its slot while the paths of this frame were traced, or kNoCell.
  RELUME_HD uint32_t find(const CellPoint& p, uint32_t noted) const {
    return noted != kNoCell && !renumbered ? noted : find(keys.address(p));
  }

  /// Address of the cell of `p`: read from its slot, or computed from its key for kNoCell.
  RELUME_HD CellAddress address(const CellPoint& p, uint32_t slot) const {
    return slot == kNoCell ? keys.address(p) : CellAddress{fingerprints[slot], bucket_hashes[slot]};
  }

  /// Slot of a cell, inserted if necessary; kNoCell if no probed slot is free.
  RELUME_HD uint32_t find_or_insert(const CellAddress& address) const {
    uint32_t slot = first_slot(address);
    for (uint32_t i = 0; i < probe_limit; ++i) {
      uint64_t found = atomic_load(&fingerprints[slot]);
      if (found == 0) {
        found = atomic_compare_exchange(&fingerprints[slot], 0, address.fingerprint);
        if (found == 0) {
          bucket_hashes[slot] = address.bucket_hash;
          atomic_add(&counters[0].made, uint64_t{1});
          return slot;
        }
      }
      if (found == address.fingerprint) return slot;
      slot = slot + 1 == fingerprints.size ? 0 : slot + 1;
    }
    return kNoCell;
  }

  /// Adds a sample to the cell of `p` and, with `u` in [0, 1) at random, to coarser cells that are pooled with
  /// undersampled ones. Weights within a cell must be inversely proportional to the probabilities of the samples.
  /// `slot`: slot of the cell of `p`, if known. `alone`: the cell is never pooled and inherits nothing. Returns the
  /// slot; kNoCell if the sample was rejected or waits.
  RELUME_HD uint32_t insert(const CellPoint& p, Rgb value, float weight, float u, uint32_t slot = kNoCell,
                            bool alone = false) const {
    if (!is_finite(value)) {
      atomic_add(&counters[0].nonfinite, uint64_t{1});
      return kNoCell;
    }
    if (slot == kNoCell) slot = find_or_insert(keys.address(p));
    value = bounded(value, own_moments(slot));
    add({p, value, weight, 0, alone}, slot);
    if (alone) return slot;
    float probability = coarser_probability;
    for (int k = 1; k <= coarser_levels && u < probability; ++k, probability *= coarser_probability)
      add({p, value, weight, k, alone}, find_or_insert(keys.address(p, k)));
    return slot;
  }

  /// Adds a finite sample to the cell one level below that of `p`, which is never pooled and inherits nothing.
  RELUME_HD void insert_finer(const CellPoint& p, const Rgb& value, float weight) const {
    if (!is_finite(value)) return;
    const uint32_t slot = find_or_insert(keys.address(p, -1));
    add({p, bounded(value, own_moments(slot)), weight, -1, true}, slot);
  }

  /// Adds a sample to the cell in `slot`, or to the waiting list for kNoCell.
  RELUME_HD void add(const WaitingSample& sample, uint32_t slot) const {
    if (slot == kNoCell) {
      if (!overflow.add(sample)) atomic_add(&counters[0].dropped, uint64_t{1});
      return;
    }
    const bool is_first = sums[slot].add(sample.value, sample.weight);
    const bool inherits = sample.coarser == 0 && !sample.alone && inherited_count > 0.0f;
    if (is_first && inherits && histories[slot].empty()) choose_parent(sample.point, slot);
  }

  /// Moments of the cell of `p`. Undersampled cells are pooled according to `undersampled_cells`. Without samples, the
  /// count is 0.
  RELUME_HD CellMoments moments(const CellPoint& p) const { return moments(p, find(keys.address(p))); }

  /// The same with the known slot of the cell of `p` (kNoCell: none).
  RELUME_HD CellMoments moments(const CellPoint& p, uint32_t slot) const {
    const CellMoments own = own_moments(slot);
    if (!undersampled(own) || undersampled_cells == UndersampledCells::keep) return own;
    CellMoments sum = undersampled_cells == UndersampledCells::coarser ? own : neighbourhood(p);
    for (int k = 1; k <= coarser_levels && undersampled(sum); ++k)
      sum = pooled(sum, own_moments(find(keys.address(p, k))), kInfinity);
    return sum;
  }

  /// Moments of the cell alone.
  RELUME_HD CellMoments own_moments(uint32_t slot) const {
    return slot == kNoCell ? CellMoments{} : histories[slot].moments;
  }

  /// Moments that the new cell in `slot` inherits.
  RELUME_HD CellMoments inherited(uint32_t slot) const {
    CellMoments m = own_moments(parents[slot]);
    m.count = relume::min(m.count, inherited_count);
    return m;
  }

  RELUME_HD bool undersampled(const CellMoments& m) const { return m.count < rule.min_count; }

  /// Share of occupied slots near the one where probing begins.
  RELUME_HD float occupancy(const CellAddress& address) const {
    constexpr uint32_t kWindow = 8;  // fingerprints in a cache line
    const uint32_t first = first_slot(address) & ~(kWindow - 1);
    uint32_t taken = 0;
    uint32_t count = 0;
    for (; count < kWindow && first + count < fingerprints.size; ++count)
      taken += fingerprints[first + count] != 0 ? 1u : 0u;
    return static_cast<float>(taken) / static_cast<float>(count);
  }

 private:
  RELUME_HD Rgb bounded(const Rgb& value, const CellMoments& known) const {
    Rgb v = glm::max(value, Rgb(0));
    if (clamp_factor > 0.0f && !undersampled(known)) {
      const float limit = clamp_factor * luminance(known.mean);
      const float y = luminance(v);
      if (y > limit) v *= limit / y;
    }
    if (max_component(v) > kCellSampleMax) {
      atomic_add(&counters[0].saturated, uint64_t{1});
      v = glm::min(v, Rgb(kCellSampleMax));
    }
    return v;
  }

  /// Links a new cell to the cell of the next coarser level that contains its centre, else of the finer one.
  RELUME_HD void choose_parent(const CellPoint& p, uint32_t slot) const {
    const int level = keys.level_of(p);
    const glm::dvec3 middle = keys.middle(p.position, level);
    for (int other = level + 1; other >= level - 1; other -= 2) {
      const uint32_t parent = find(keys.address_at(middle, p, other, 0));
      if (parent == kNoCell || histories[parent].empty()) continue;
      parents[slot] = parent;
      atomic_add(&counters[0].inherited_cells, uint64_t{1});
      return;
    }
  }

  /// Pools the eight cells around the corner nearest to `p`, including its own.
  RELUME_HD CellMoments neighbourhood(const CellPoint& p) const {
    const int level = keys.level_of(p);
    const glm::i64vec3 corner(glm::floor(keys.grid_position(glm::dvec3(p.position), level) - 0.5));
    CellMoments sum;
    for (int i = 0; i < 8; ++i) {
      const glm::i64vec3 v = corner + glm::i64vec3(i & 1, (i >> 1) & 1, i >> 2);
      sum = pooled(sum, own_moments(find(keys.address_of(v, p, level, 0))), kInfinity);
    }
    return sum;
  }
};

}  // namespace relume
