// The part of the mean that comes from a radiance cache, in forward reprojection. It moves with the history where eq.
// 15 allows. Elsewhere this frame looks up the cell from the new viewpoint, and only the rest of the mean moves.
#pragma once

#include "techniques/temporal/reprojection/look_back.h"

namespace relume {

/// Moves the part from cells, after the moments have moved and before their counts are limited.
struct CellsHistoryKernel {
  LookBack look_back;            ///< of filled pixels; empty: none are filled
  View<const uint32_t> sources;  ///< pixel of the previous frame, or kNoSource
  View<const uint32_t> reasons;  ///< RejectReason by pixel of this frame
  View<const uint32_t> limits;   ///< maximum sample count of each history
  View<const Rgb> before;
  View<const uint32_t> samples_before;
  View<Rgb> mean;  ///< mean of the moved history, which contains this part
  View<Rgb> now;
  View<uint32_t> samples;
  uint32_t max_samples = 1;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const uint32_t source = sources[pixel];
    now[pixel] = Rgb(0);
    samples[pixel] = 0;
    if (source == kNoSource) return;
    const bool filled = reasons[pixel] == static_cast<uint32_t>(RejectReason::filled);
    const BackwardTaps taps = filled ? look_back.taps(x, y) : one_tap(source);
    const Rgb cells = taps.fetch(before);
    const bool differs = reasons[pixel] == static_cast<uint32_t>(RejectReason::looked_up) || (filled && differ(taps));
    if (differs) {
      mean[pixel] -= cells;
      return;
    }
    now[pixel] = cells;
    samples[pixel] = relume::min(taps.least(samples_before), relume::min(limits[pixel], max_samples));
  }

 private:
  RELUME_HD static BackwardTaps one_tap(uint32_t source) {
    BackwardTaps taps;
    taps.pixels[0] = source;
    taps.weights[0] = 1.0f;
    taps.valid = true;
    return taps;
  }

  /// Whether the light of cells looks different at any tap.
  RELUME_HD bool differ(const BackwardTaps& taps) const {
    for (int k = 0; k < 4; ++k) {
      if (!(taps.weights[k] > 0.0f)) continue;
      if (look_back.reject_reasons[taps.pixels[k]] == static_cast<uint32_t>(RejectReason::looked_up)) return true;
    }
    return false;
  }
};

}  // namespace relume
