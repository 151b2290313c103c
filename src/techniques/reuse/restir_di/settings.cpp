#include "techniques/reuse/restir_di/settings.h"

#include "techniques/reuse/reservoir/reuse_settings.h"

namespace relume {

SettingList describe(RestirSettings& s) {
  SettingList list = {
      {"correction",
       choice(s.correction, {"exact", "lagging", "basic"}),
       "Weights of reservoirs. exact: with shadow rays, and without history where geometry moves: unbiased; lagging: "
       "histories survive moving geometry, with bias there; basic: without shadow rays in the weights, darker near "
       "shadows",
       {.biases = true}},
  };
  declare_reuse(
      list, s,
      "Number of neighbouring pixels whose reservoirs a pixel reuses, with up to two shadow rays each; 0: none");
  return list;
}

}  // namespace relume
