// How far a mean of squares strays by chance.
#pragma once

#include "core/vec.h"

namespace relume {

/// By how much the mean of `count` > 0 squares of standard normal numbers exceeds 1 with a probability of at most
/// e^(−t²/2), `t` standard errors ≥ 0: [Laurent00], lemma 1, for χ² with `count` degrees of freedom, divided by them.
RELUME_HD inline float chi2_mean_bound(float count, float t) {
  const float x = 0.5f * sqr(t) / count;
  return 2.0f * (std::sqrt(x) + x);
}

}  // namespace relume
