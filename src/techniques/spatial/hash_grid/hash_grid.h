// The hash grid: an open-addressing table of cells that kernels fill and read at the same time ([Binder19], §3.2).
// Samples of the running frame go into integer sums, what is read are moments that a pass of its own makes of them, so
// nothing that a kernel reads depends on what others have written ([Schipek22 §5.3], double buffering).
#pragma once

#include "core/view.h"
#include "techniques/spatial/hash_grid/cell.h"
#include "techniques/spatial/hash_grid/cell_key.h"
#include "techniques/spatial/hash_grid/overflow.h"

namespace relume {

/// No slot: the cell is not in the table.
inline constexpr uint32_t kNoCell = 0xffffffffu;

/// Slots that are probed for a new key. Samples of a key that finds none of them free wait until the table has grown.
inline constexpr uint32_t kMaxProbes = 256;

/// Slots over which the cells of one voxel spread; a power of two.
inline constexpr uint32_t kBucketSlots = 64;

/// Events that the program reports.
struct HashGridCounters {
  uint64_t dropped = 0;           ///< samples for which there was no memory
  uint64_t saturated = 0;         ///< samples clamped to kCellSampleMax
  uint64_t nonfinite = 0;         ///< samples that were not finite, and were left out
  uint64_t made = 0;              ///< keys that this frame has placed in the table
  uint64_t inherited_cells = 0;   ///< cells of this frame that begin with what another level knows
  uint64_t skipped_vertices = 0;  ///< vertices of paths that took no sample, as too many before them waited for theirs
};

/// Levels above its own that a thin cell may be replaced from, and the probability with which a sample goes one higher.
inline constexpr int kCoarserLevels = 3;
inline constexpr float kCoarserProbability = 0.125f;

struct HashGridView {
  View<uint64_t> fingerprints;   ///< 0: free
  View<uint32_t> bucket_hashes;  ///< hash that chose the slot, for moving cells to another table
  View<uint32_t> parents;        ///< slot of the cell that a new one begins with, or kNoCell
  View<CellSums> sums;           ///< this frame
  View<const CellHistory> histories;
  HashGridCounters* counters = nullptr;
  OverflowView overflow;
  uint32_t probe_limit = kMaxProbes;  ///< slots between a key and its first slot, at most
  bool renumbered = false;            ///< the table has been rebuilt since the paths of this frame
  CellKeys keys;
  AveragingRule rule;
  ThinCells thin_cells = ThinCells::coarser;
  float inherited_count = 0;  ///< most samples that a new cell takes over from another level; 0: none
  float clamp_factor = 0;     ///< samples are cut to this multiple of their cell's mean; 0: not

  RELUME_HD uint32_t slot_of(uint32_t bucket_hash) const {
    return static_cast<uint32_t>((static_cast<uint64_t>(bucket_hash) * fingerprints.size) >> 32);
  }

  /// Where probing begins. Cells of one voxel, which share a bucket hash, begin at different slots close by: at curved
  /// or bumpy surfaces there are many of them, and each would be probed past all the others.
  RELUME_HD uint32_t first_slot(const CellAddress& address) const {
    const uint32_t slot =
        slot_of(address.bucket_hash) + (static_cast<uint32_t>(address.fingerprint) & (kBucketSlots - 1));
    return slot < fingerprints.size ? slot : slot % fingerprints.size;
  }

  /// Slots between a key in `slot` and where probing for it begins.
  RELUME_HD uint32_t displacement(const CellAddress& address, uint32_t slot) const {
    const uint32_t first = first_slot(address);
    return slot >= first ? slot - first : slot + fingerprints.size - first;
  }

  /// Send for what will be read of a cell soon, or added to: it is rarely near, and who adds cannot go on meanwhile.
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

  /// Slot of a cell that is in the table, else kNoCell.
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

  /// The same for a cell whose slot may have been noted while the paths of this frame were traced.
  RELUME_HD uint32_t find(const CellPoint& p, uint32_t noted) const {
    return noted != kNoCell && !renumbered ? noted : find(keys.address(p));
  }

  /// Slot of a cell, made if necessary; kNoCell if there is no room.
  RELUME_HD uint32_t find_or_insert(const CellAddress& address) const {
    uint32_t slot = first_slot(address);
    for (uint32_t i = 0; i < probe_limit; ++i) {
      uint64_t found = atomic_load(&fingerprints[slot]);
      if (found == 0) {
        found = atomic_compare_exchange(&fingerprints[slot], 0, address.fingerprint);
        if (found == 0) {
          bucket_hashes[slot] = address.bucket_hash;
          atomic_add(&counters->made, uint64_t{1});
          return slot;
        }
      }
      if (found == address.fingerprint) return slot;
      slot = slot + 1 == fingerprints.size ? 0 : slot + 1;
    }
    return kNoCell;
  }

  /// Adds a sample to the cell of `p` and, at random, to the coarser ones that replace it while it is thin. Samples of
  /// one cell must have weights in inverse proportion to the probabilities with which they were taken. `u` in [0, 1).
  /// `slot`: of the cell of `p`, if it is known to have one. `alone`: no other cell ever replaces this one. Returns the
  /// slot; kNoCell if the sample was left out or waits for the table to grow.
  RELUME_HD uint32_t insert(const CellPoint& p, Rgb value, float weight, float u, uint32_t slot = kNoCell,
                            bool alone = false) const {
    if (!is_finite(value)) {
      atomic_add(&counters->nonfinite, uint64_t{1});
      return kNoCell;
    }
    if (slot == kNoCell) slot = find_or_insert(keys.address(p));
    value = bounded(value, own_moments(slot));
    add({p, value, weight, 0, alone}, slot);
    if (alone || thin_cells != ThinCells::coarser) return slot;
    float probability = kCoarserProbability;
    for (int k = 1; k <= kCoarserLevels && u < probability; ++k, probability *= kCoarserProbability)
      add({p, value, weight, k, alone}, find_or_insert(keys.address(p, k)));
    return slot;
  }

  /// Adds to the cell in `slot`; kNoCell: the sample waits.
  RELUME_HD void add(const WaitingSample& sample, uint32_t slot) const {
    if (slot == kNoCell) {
      if (!overflow.add(sample)) atomic_add(&counters->dropped, uint64_t{1});
      return;
    }
    const bool is_first = sums[slot].add(sample.value, sample.weight);
    const bool inherits = sample.coarser == 0 && !sample.alone && inherited_count > 0.0f;
    if (is_first && inherits && histories[slot].empty()) choose_parent(sample.point, slot);
  }

  /// Moments at `p`; too thin cells are replaced as `thin_cells` says. Count 0: nothing is known.
  RELUME_HD CellMoments moments(const CellPoint& p) const { return moments(p, find(keys.address(p))); }

  /// The same, if the slot of the cell of `p` is known already (kNoCell: it has none).
  RELUME_HD CellMoments moments(const CellPoint& p, uint32_t slot) const {
    const CellMoments own = own_moments(slot);
    if (!undersampled(own) || thin_cells == ThinCells::keep) return own;
    if (thin_cells == ThinCells::neighbours) return neighbourhood(p);
    CellMoments sum = own;
    for (int k = 1; k <= kCoarserLevels && undersampled(sum); ++k)
      sum = pooled(sum, own_moments(find(keys.address(p, k))), kInfinity);
    return sum;
  }

  /// Moments of a cell itself, whatever stands in for it.
  RELUME_HD CellMoments own_moments(uint32_t slot) const {
    return slot == kNoCell ? CellMoments{} : histories[slot].moments;
  }

  /// What the new cell in `slot` begins with.
  RELUME_HD CellMoments inherited(uint32_t slot) const {
    CellMoments m = own_moments(parents[slot]);
    m.count = relume::min(m.count, inherited_count);
    return m;
  }

  RELUME_HD bool undersampled(const CellMoments& m) const { return m.count < rule.min_count; }

  /// Share of taken slots among those where probing begins: how crowded that part of the table is.
  RELUME_HD float occupancy(const CellAddress& address) const {
    constexpr uint32_t kWindow = 8;  // one line of a processor's cache
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
      atomic_add(&counters->saturated, uint64_t{1});
      v = glm::min(v, Rgb(kCellSampleMax));
    }
    return v;
  }

  /// A cell that is new where the level has changed goes on from what the other level knows of its middle.
  RELUME_HD void choose_parent(const CellPoint& p, uint32_t slot) const {
    const int level = keys.level_of(p);
    const glm::dvec3 middle = keys.middle(p.position, level);
    for (int other = level + 1; other >= level - 1; other -= 2) {
      const uint32_t parent = find(keys.address_at(middle, p, other, 0));
      if (parent == kNoCell || histories[parent].empty()) continue;
      parents[slot] = parent;
      atomic_add(&counters->inherited_cells, uint64_t{1});
      return;
    }
  }

  /// The eight cells around the corner nearest to `p`, its own among them.
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
