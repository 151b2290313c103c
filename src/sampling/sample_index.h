// Which sample of which pixel is being taken.
#pragma once

#include "sampling/sampler.h"

namespace relume {

struct SampleIndex {
  uint32_t seed = 0;
  uint32_t frame = 0;
  uint32_t sample = 0;       ///< index within the sequence, or within the frame
  bool independent = false;  ///< a scramble of its own each frame: for whatever adapts to earlier frames

  RELUME_HD uint32_t scramble_frame() const { return independent ? frame : Sampler::kAllFrames; }
  RELUME_HD_INLINE Sampler sampler(uint32_t x, uint32_t y) const {
    return Sampler::independent(seed, x, y, scramble_frame(), sample);
  }
};

}  // namespace relume
