// What light selection strategies return.
#pragma once

#include "lights/light.h"

namespace relume {

struct LightSelection {
  LightId light = kNoLight;
  float pmf = 0;  ///< probability of this light at this point; 0: no light was chosen
  /// What is left of the random number, uniform in [0, 1): keeps strata when it goes on to place the sample.
  float u = 0;
};

}  // namespace relume
