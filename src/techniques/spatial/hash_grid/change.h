// Detects changes of the light in cells: compares windows of recent samples with histories. A few noisy samples of one
// cell cannot show a change; the cells of a region together can. After a change, most of them deviate by more than
// their noise, though not all to the same side.
#pragma once

#include "sampling/chi2_bound.h"
#include "techniques/spatial/hash_grid/cell.h"

namespace relume {

/// Regions are cubes of 2^kRegionLevels cells along an edge, of one level and layer. The lowest bits of a key's bucket
/// hash are a hash of its region. Regions with the same hash are treated as one.
inline constexpr uint32_t kRegionBits = 14;
inline constexpr int kRegionLevels = 3;
inline constexpr uint32_t kRegions = 1u << kRegionBits;

RELUME_HD constexpr uint32_t region_of(uint32_t bucket_hash) { return bucket_hash & (kRegions - 1); }

/// Squared difference between the means of a window and of the history, divided by its expected value under noise: 1
/// on average while nothing changes. Bounded, so that single bright samples do not decide.
RELUME_HD inline float squared_departure(const CellMoments& history, const CellMoments& window) {
  constexpr float kLargest = 9;
  const Departure d = departure_of(history, window);
  const float expected = d.noise_squared + d.rounding_squared;
  return expected > 0.0f ? relume::min(sqr(d.difference) / expected, kLargest) : 0.0f;
}

/// Sums over the cells of a region in one frame, as integers that do not depend on the order of additions.
struct RegionChange {
  static constexpr float kUnit = 0x1p-16f;
  uint64_t squares = 0;  ///< sum of squared_departure() in units of kUnit
  uint64_t cells = 0;

  /// Thread-safe.
  RELUME_HD void add(float square) {
    atomic_add(&squares, static_cast<uint64_t>(square / kUnit));
    atomic_add(&cells, uint64_t{1});
  }

  /// The mean square minus 1 if it exceeds the χ² bound at `threshold` standard errors, else 0.
  RELUME_HD float excess(float threshold) const {
    if (cells == 0) return 0.0f;
    const auto count = static_cast<float>(cells);
    const float mean = static_cast<float>(squares) * kUnit / count - 1.0f;
    return mean > chi2_mean_bound(count, threshold) ? mean : 0.0f;
  }
};

/// Factor of the cells' threshold for regions. Half as many standard errors suffice, because regions are tested only
/// after a change of the scene.
inline constexpr float kRegionThreshold = 0.5f;

/// The history after a change, with the number of samples whose noise would equal its expected error. `excess`: mean
/// squared_departure() minus 1.
RELUME_HD inline CellMoments discounted(const CellMoments& history, const CellMoments& window, float excess) {
  const float noise = 1.0f / history.count + 1.0f / window.count;
  CellMoments m = history;
  m.count = 1.0f / (excess * noise + 1.0f / history.count);
  return m;
}

/// Excess of one cell in a changed region: its own square minus 1 where that is larger and beyond two standard errors.
RELUME_HD inline float own_excess(const CellMoments& history, const CellMoments& window, float region) {
  constexpr float kNoise = 4;  // two standard errors
  const float square = squared_departure(history, window);
  return square > kNoise ? relume::max(region, square - 1.0f) : region;
}

/// Frames of a history after another frame with samples. Those without samples count for a limit of frames only.
RELUME_HD inline uint32_t frames_after(const CellHistory& history, const AveragingRule& rule) {
  return history.frames + 1u + (rule.max_frames > 0 ? history.age : 0u);
}

/// Number of frames that the average of a cell is worth after `frames` frames: half of them, at most `max_frames`.
RELUME_HD inline float window_of(uint32_t frames, const AveragingRule& rule) {
  const float least = frames > 0 ? 1.0f : 0.0f;
  return relume::min(relume::max(0.5f * static_cast<float>(frames), least), static_cast<float>(rule.max_frames));
}

/// Moments of the history as they enter an average of the latest frames. The first samples of a young cell may lack
/// light and fade early, but only beyond the number that makes the cell known.
RELUME_HD inline CellMoments faded(const CellHistory& history, const AveragingRule& rule) {
  CellMoments m = history.moments;
  if (rule.max_frames == 0) return m;
  const float frames = window_of(history.frames, rule) + static_cast<float>(1u + history.age);
  const float limited = m.count * relume::min(1.0f, static_cast<float>(rule.max_frames) / frames);
  const float early = m.count * relume::min(1.0f, window_of(frames_after(history, rule), rule) / frames);
  m.count = relume::max(early, relume::min(limited, rule.min_count));
  return m;
}

/// The history after a frame with the samples `frame` (at least one). A window pools frames until it has enough samples
/// to be compared with the history. A changed cell restarts from the window. `excess`: RegionChange::excess() of the
/// cell's region.
RELUME_HD inline CellHistory advanced(const CellHistory& history, const CellMoments& frame, const AveragingRule& rule,
                                      float excess = 0) {
  CellHistory next;
  next.frames = frames_after(history, rule);
  if (rule.max_frames > 0) next.frames = relume::min(next.frames, 2u * rule.max_frames);
  next.departure = history.departure;
  next.changed = history.changed;
  if (rule.change_threshold > 0.0f) {
    next.recent = pooled(history.recent, frame, kInfinity);
    if (next.recent.count >= rule.min_count) {
      const int side = departure(history.moments, next.recent, rule);
      next.departure = static_cast<int16_t>(side * history.departure > 0 ? history.departure + side : side);
      next.changed = side != 0 || excess > 0.0f ? 1 : 0;
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
  next.moments = pooled(faded(history, rule), frame, rule.max_count);
  return next;
}

}  // namespace relume
