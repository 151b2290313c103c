// Duplication map of ReSTIR PT ([Lin26]): where a few paths have spread over many pixels, histories count less, so that
// new paths replace them.
#pragma once

#include "core/math.h"
#include "techniques/reuse/restir_pt/stored_path.h"

namespace relume {

/// The window around each pixel in which its path is counted, and the number of other pixels in it.
inline constexpr uint32_t kDuplicateRadius = 8;
inline constexpr uint32_t kMostDuplicates = (2 * kDuplicateRadius + 1) * (2 * kDuplicateRadius + 1) - 1;

/// How much histories count, by the published formula of RTXDI.
struct DuplicateLimit {
  float exponent = 0;  ///< of the fraction of duplicates; 0: all histories have the same cap

  /// `strength`: in [0, 1]; 0: all histories have the same cap.
  static DuplicateLimit of(float strength) {
    return {strength > 0.0f ? 0.1f * math::exp2(6.0f * (1.0f - strength) - 3.0f) : 0.0f};
  }

  /// Cap of a history with `duplicates` copies of its path nearby, between `cap`, at least 1, and 1; in frames.
  RELUME_HD float at(float cap, uint32_t duplicates) const {
    if (exponent == 0.0f || duplicates == 0) return cap;
    constexpr float kPerDuplicate = 1.0f / static_cast<float>(static_cast<int>(kMostDuplicates));
    const float fraction = static_cast<float>(static_cast<int>(duplicates)) * kPerDuplicate;
    return cap + (1.0f - cap) * math::pow(fraction, exponent);
  }
};

/// Whether two paths come from the same random numbers. They may end at different lights.
RELUME_HD inline bool are_duplicates(const StoredPath& a, const StoredPath& b) {
  return a.pixel == b.pixel && a.seed == b.seed && a.sequence == b.sequence && a.element == b.element;
}

/// Counts the pixels around each one whose reservoirs have the same path.
struct PathDuplicatesKernel {
  View<const PathReservoir> history;  ///< of the previous frame
  View<uint32_t> duplicates;          ///< by pixel of the previous frame
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const PathReservoir& own = history[pixel];
    uint32_t count = 0;
    if (own.weight > 0.0f) {
      const uint32_t x0 = x - relume::min(x, kDuplicateRadius);
      const uint32_t y0 = y - relume::min(y, kDuplicateRadius);
      const uint32_t x1 = relume::min(x + kDuplicateRadius + 1, width);
      const uint32_t y1 = relume::min(y + kDuplicateRadius + 1, height);
      for (uint32_t v = y0; v < y1; ++v) {
        for (uint32_t u = x0; u < x1; ++u) {
          const PathReservoir& other = history[v * width + u];
          count += other.weight > 0.0f && are_duplicates(own.sample, other.sample) ? 1u : 0u;
        }
      }
      --count;  // the pixel itself
    }
    duplicates[pixel] = count;
  }
};

}  // namespace relume
