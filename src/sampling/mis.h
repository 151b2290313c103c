// Multiple importance sampling.
#pragma once

#include "core/vec.h"

namespace relume {

/// Power heuristic with β = 2 for one sample of each of two strategies ([Veach97], eq. 9.13): the weight of the one
/// with density `pdf`. Both densities in the same measure; `pdf` > 0.
RELUME_HD inline float power_heuristic(float pdf, float other_pdf) {
  const float ratio = other_pdf / pdf;
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace relume
