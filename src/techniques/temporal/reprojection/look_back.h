// What forward reprojection does where no history comes to lie: the pixel looks back, among histories that passed
// validation where they were.
#pragma once

#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// Finds the histories that a pixel may continue between.
struct LookBack {
  BackwardReprojection reprojection;
  View<const uint32_t> reject_reasons;  ///< RejectReason of the pixels of the frame before
  View<const uint32_t> limits;          ///< samples that their histories may count for

  RELUME_HD bool empty() const { return reprojection.motion.empty(); }

  /// Bilinear taps that show this pixel's surface and passed validation. Those that saw several surfaces are among
  /// them: this pixel's own surface is known.
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
    return (reject_reason == RejectReason::none || reject_reason == RejectReason::mixed) && limits[pixel] > 0;
  }
};

/// After histories have moved: those of filled pixels are interpolated.
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
