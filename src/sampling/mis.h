// Multiple importance sampling.
#pragma once

#include "core/vec.h"

namespace relume {

/// Weight of the strategy with density `pdf` by the power heuristic with β = 2, for one sample of each of two
/// strategies ([Veach97], eq. 9.13). Both densities have the same measure; `pdf` > 0.
RELUME_HD inline float power_heuristic(float pdf, float other_pdf) {
  const float ratio = other_pdf / pdf;
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace relume
