// Whether part of the scene has changed: what its cells have gathered of late against what they remembered. One cell
// with a few noisy samples says little. The cells of a region say it together: after a change all of them tend to stray
// by more than their noise, if not to the same side.
#pragma once

#include "sampling/chi2_bound.h"
#include "techniques/spatial/hash_grid/cell.h"

namespace relume {

/// Regions are cubes of 2^kRegionLevels cells along an edge, of one level and layer. A key's bucket hash holds a hash
/// of its region in the lowest bits; regions that share one are seen as one.
inline constexpr uint32_t kRegionBits = 14;
inline constexpr int kRegionLevels = 3;
inline constexpr uint32_t kRegions = 1u << kRegionBits;

RELUME_HD constexpr uint32_t region_of(uint32_t bucket_hash) { return bucket_hash & (kRegions - 1); }

/// Squared difference between the means of a window and of the history, in units of what noise makes of it: 1 on
/// average while nothing changes. Bounded, for single bright samples must not decide.
RELUME_HD inline float squared_departure(const CellMoments& history, const CellMoments& window) {
  constexpr float kLargest = 9;
  const Departure d = departure_of(history, window);
  const float expected = d.noise_squared + d.rounding_squared;
  return expected > 0.0f ? relume::min(sqr(d.difference) / expected, kLargest) : 0.0f;
}

/// The cells of a region in one frame, as integers: the order in which they come does not matter.
struct RegionChange {
  static constexpr float kUnit = 0x1p-16f;
  uint64_t squares = 0;  ///< sum of squared_departure() in units of kUnit
  uint64_t cells = 0;

  /// Thread-safe.
  RELUME_HD void add(float square) {
    atomic_add(&squares, static_cast<uint64_t>(square / kUnit));
    atomic_add(&cells, uint64_t{1});
  }

  /// By how much the mean square exceeds 1, if chance does not explain it; else 0. `threshold`: standard errors.
  RELUME_HD float excess(float threshold) const {
    if (cells == 0) return 0.0f;
    const auto count = static_cast<float>(cells);
    const float mean = static_cast<float>(squares) * kUnit / count - 1.0f;
    return mean > chi2_mean_bound(count, threshold) ? mean : 0.0f;
  }
};

/// Regions are asked only after something has changed somewhere. That makes half as many standard errors enough.
inline constexpr float kRegionThreshold = 0.5f;

/// What a history is worth after a change: it counts for as many samples as would be off by as much. `excess`: of
/// squared_departure() over 1.
RELUME_HD inline CellMoments discounted(const CellMoments& history, const CellMoments& window, float excess) {
  const float noise = 1.0f / history.count + 1.0f / window.count;
  CellMoments m = history;
  m.count = 1.0f / (excess * noise + 1.0f / history.count);
  return m;
}

/// In a region that has changed, a cell may have changed by more than the others.
RELUME_HD inline float own_excess(const CellMoments& history, const CellMoments& window, float region) {
  constexpr float kNoise = 4;  // two standard errors
  const float square = squared_departure(history, window);
  return square > kNoise ? relume::max(region, square - 1.0f) : region;
}

/// The history after a frame with the samples `frame` (at least one). Frames with few samples are gathered in a window
/// until they are enough to be compared with the history; what has changed starts anew from the window. `excess`: of
/// the cell's region, RegionChange::excess().
RELUME_HD inline CellHistory advanced(const CellHistory& history, const CellMoments& frame, const AveragingRule& rule,
                                      float excess = 0) {
  CellHistory next;
  next.frames = history.frames + 1;
  next.departure = history.departure;
  if (rule.change_threshold > 0.0f) {
    next.recent = pooled(history.recent, frame, kInfinity);
    if (next.recent.count >= rule.min_count) {
      const int side = departure(history.moments, next.recent, rule);
      next.departure = side * history.departure > 0 ? history.departure + side : side;
      if (next.departure >= kDeparturesOfAChange || next.departure <= -kDeparturesOfAChange) {
        next.moments = next.recent;
        next.moments.count = relume::min(next.moments.count, rule.max_count);
        next.recent = {};
        next.departure = 0;
        next.frames = 1;
        return next;
      }
      if (excess > 0.0f && history.moments.count >= rule.min_count) {
        next.moments =
            pooled(discounted(history.moments, next.recent, own_excess(history.moments, next.recent, excess)),
                   next.recent, rule.max_count);
        next.recent = {};
        return next;
      }
      next.recent = {};
    }
  }
  next.moments = pooled(history.moments, frame, rule.max_count);
  return next;
}

}  // namespace relume
