// The error of an accumulated image, estimated from the variances of its pixels.
#pragma once

#include "core/vec.h"
#include "frame/launch.h"
#include "frame/primitives/reduce.h"
#include "framebuffer/pixel_moments.h"
#include "techniques/temporal/accumulate/accumulate.h"

namespace relume {

/// Buffers of SplatImage, from the present stage.
struct SplatImageBuffers {
  View<const float> m2;
  View<const float> weight;
  View<const uint32_t> frames;
};

/// Sums over pixels.
struct ImageErrorSums {
  double variance = 0;        ///< of the pixels' means
  double luminance = 0;       ///< of the pixels' means
  uint32_t undersampled = 0;  ///< 1 if any pixel has too few samples for an estimate
};

struct AddImageErrors {
  using Value = ImageErrorSums;
  RELUME_HD static constexpr Value identity() { return {}; }
  RELUME_HD static constexpr Value combine(const Value& a, const Value& b) {
    return {a.variance + b.variance, a.luminance + b.luminance, a.undersampled | b.undersampled};
  }
};

/// Errors of the pixels of a window.
struct ImageErrors {
  MomentsView moments;
  SplatImageBuffers splats;
  Tile window = {};
  uint32_t width = 0;              ///< of the image
  uint32_t correlated_frames = 1;  ///< as Pass::correlated_frames()

  uint32_t pixels() const { return (window.x1 - window.x0) * (window.y1 - window.y0); }

  RELUME_HD ImageErrorSums operator()(size_t i) const {
    const uint32_t columns = window.x1 - window.x0;
    const auto n = static_cast<uint32_t>(i);
    const uint32_t pixel = (window.y0 + n / columns) * width + window.x0 + n % columns;
    if (moments.samples[pixel] < relume::max(2u, correlated_frames)) return {0, 0, 1};
    double variance = variance_of_mean(moments.m2[pixel], moments.samples[pixel], correlated_frames);
    if (!splats.m2.empty()) variance += splat_variance(splats.m2[pixel], splats.weight[pixel], splats.frames[pixel]);
    return {variance, luminance(moments.mean[pixel]), 0};
  }
};

}  // namespace relume
