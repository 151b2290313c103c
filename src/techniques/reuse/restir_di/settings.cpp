#include "techniques/reuse/restir_di/settings.h"

namespace relume {

SettingList describe(RestirSettings& s) {
  return {
      {"correction",
       choice(s.correction, {"exact", "lagging", "basic"}),
       "Weights of reservoirs. exact: with shadow rays, and without history where geometry moves: unbiased; lagging: "
       "histories survive moving geometry, with bias there; basic: without shadow rays in the weights, darker near "
       "shadows",
       {.biases = true}},
      {"feedback", choice(s.feedback, {"temporal", "spatial"}),
       "Reservoirs that the next frame reuses: those before (temporal) or after (spatial) the reuse of neighbouring "
       "pixels"},
      {"cap",
       &s.cap,
       "Maximum weight of a reservoir's history, in frames; 0: no reuse of earlier frames",
       {.min = 0, .max = 1000}},
      {"neighbours",
       &s.neighbours,
       "Number of neighbouring pixels whose reservoirs a pixel reuses, with up to two shadow rays each; 0: none",
       {.min = 0, .max = kMostReuseNeighbours}},
      {"radius", &s.radius, "Maximum distance of these neighbours", {.min = 1, .max = 1000, .unit = "pixels"}},
  };
}

}  // namespace relume
