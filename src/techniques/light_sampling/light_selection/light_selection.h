// The result of a light selection strategy.
#pragma once

#include "lights/light.h"

namespace relume {

struct LightSelection {
  LightId light = kNoLight;
  float pmf = 0;  ///< probability of this light at this point; 0: no light chosen
  /// Rest of the random number, uniform in [0, 1). Reusing it on the light keeps samples stratified.
  float u = 0;
};

}  // namespace relume
