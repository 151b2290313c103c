// Backward look-up for pixels without a vote in forward reprojection, among histories that passed validation.
#pragma once

#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// Finds the histories between which a pixel may continue.
struct LookBack {
  BackwardReprojection reprojection;
  View<const uint32_t> reject_reasons;  ///< RejectReason by pixel of the previous frame
  View<const uint32_t> limits;          ///< sample counts to which their histories are limited

  RELUME_HD bool empty() const { return reprojection.motion.empty(); }

  /// Bilinear taps that show this pixel's surface and passed validation. Taps that saw several surfaces pass too: this
  /// pixel's surface is given.
  RELUME_HD BackwardTaps taps(uint32_t x, uint32_t y) const {
    BackwardTaps result = reprojection.taps(x, y);
    for (int k = 0; k < 4; ++k) {
      if (!passed(result.pixels[k])) result.weights[k] = 0.0f;
    }
    result.normalise();
    return result;
  }

 private:
  RELUME_HD bool passed(uint32_t pixel) const {
    if (reprojection.previous_surface[pixel] == kNoSurface) return true;
    const auto reject_reason = static_cast<RejectReason>(reject_reasons[pixel]);
    return (is_kept(reject_reason) || reject_reason == RejectReason::mixed) && limits[pixel] > 0;
  }
};

/// Interpolates the histories of filled pixels, after the others have moved.
struct FillKernel {
  LookBack look_back;
  View<const uint32_t> reasons;  ///< RejectReason
  InterpolatedHistory history;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (reasons[pixel] == static_cast<uint32_t>(RejectReason::filled)) history.inherit(pixel, look_back.taps(x, y));
  }
};

}  // namespace relume
