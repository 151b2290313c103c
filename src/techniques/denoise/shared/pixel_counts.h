// Predicates and counts over pixels. Denoisers reduce them once per frame to choose their parameters.
#pragma once

#include "frame/primitives/reduce.h"
#include "techniques/gbuffer/features/features.h"

namespace relume {

/// Whether a pixel's light is filtered.
struct FilteredPixels {
  View<const Rgb> albedo;

  RELUME_HD bool operator()(size_t i) const { return is_filtered(albedo.data[i]); }
};

struct FreshCount {
  uint32_t filtered = 0;
  uint32_t fresh = 0;  ///< of the filtered ones
};

struct AddFreshCounts {
  using Value = FreshCount;
  RELUME_HD static constexpr Value identity() { return {}; }
  RELUME_HD static constexpr Value combine(const Value& a, const Value& b) {
    return {a.filtered + b.filtered, a.fresh + b.fresh};
  }
};

/// Filtered pixels, and those without samples from earlier frames. Element i is pixel i · kStride.
struct FreshPixels {
  static constexpr uint32_t kStride = 61;

  View<const Rgb> albedo;
  View<const uint32_t> samples;
  View<const uint32_t> specular_samples;
  uint32_t max_fresh_samples = 1;  ///< maximum samples of a pixel without history

  static uint32_t count(uint32_t pixels) { return pixels / kStride + (pixels % kStride > 0 ? 1 : 0); }

  RELUME_HD FreshCount operator()(size_t i) const {
    const size_t pixel = i * kStride;
    if (!is_filtered(albedo.data[pixel])) return {};
    return {1, relume::max(samples.data[pixel], specular_samples.data[pixel]) <= max_fresh_samples ? 1u : 0u};
  }
};

}  // namespace relume
