// Chooses the pixels that trace indirect light in a frame.
#pragma once

#include <cassert>

#include "core/vec.h"
#include "sampling/blue_noise.h"
#include "sampling/sample_index.h"

namespace relume {

/// In each frame a fraction of the pixels has indirect light. Blue noise spreads them evenly over the image. Each frame
/// shifts it by an independent uniform number, so that each pixel of each frame is chosen with probability `rate`,
/// whichever frames sample the pixel.
struct IndirectRate {
  View<const uint16_t> tile = {};  ///< blue noise; empty: all paths continue
  float rate = 1;
  float shift = 0;  ///< of this frame, in [0, 1)

  /// Factor of the indirect light of pixel (x, y): 1 / rate or 0.
  RELUME_HD float weight(uint32_t x, uint32_t y) const {
    if (tile.empty()) return 1.0f;
    constexpr uint32_t kMask = kBlueNoiseEdge - 1;
    constexpr float kNumbers = kBlueNoiseEdge * kBlueNoiseEdge;
    const uint32_t number = tile[(y & kMask) * kBlueNoiseEdge + (x & kMask)];
    const float shifted = (static_cast<float>(number) + 0.5f) / kNumbers + shift;
    return shifted - (shifted < 1.0f ? 0.0f : 1.0f) < rate ? 1.0f / rate : 0.0f;
  }
};

/// The choice for one frame; `rate` is in (0, 1]. `tile`: blue noise; may be empty if `rate` is 1.
inline IndirectRate indirect_rate(float rate, const SampleIndex& index, const View<const uint16_t>& tile) {
  if (rate >= 1) return {};
  assert(!tile.empty());
  constexpr uint32_t kSaltIndirect = 0x7f4a7c15u;
  return {tile, rate, to_unit_float(hash(hash(index.seed, kSaltIndirect), index.frame))};
}

}  // namespace relume
