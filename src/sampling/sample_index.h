// Which sample of which pixel is being taken.
#pragma once

#include "sampling/sampler.h"

namespace relume {

struct SampleIndex {
  uint32_t seed = 0;
  uint32_t frame = 0;
  uint32_t sample = 0;       ///< index within the sequence, or within the frame
  bool independent = false;  ///< a scramble of its own each frame: for whatever adapts to earlier frames

  RELUME_HD Sampler sampler(uint32_t x, uint32_t y) const {
    return independent ? Sampler::independent(seed, x, y, frame, sample) : Sampler::sequence(seed, x, y, sample);
  }
};

}  // namespace relume
