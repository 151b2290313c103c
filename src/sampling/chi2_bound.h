// Upper bounds on random deviations of a mean of squares.
#pragma once

#include "core/vec.h"

namespace relume {

/// Bound on the excess over 1 of the mean of `count` > 0 squared standard normal numbers. The excess is larger with a
/// probability of at most e^(−t²/2), `t` ≥ 0 standard errors. [Laurent00], lemma 1, for χ² with `count` degrees of
/// freedom, divided by them.
RELUME_HD inline float chi2_mean_bound(float count, float t) {
  const float x = 0.5f * sqr(t) / count;
  return 2.0f * (std::sqrt(x) + x);
}

}  // namespace relume
