#include "techniques/reuse/restir_di/settings.h"

namespace relume {

SettingList describe(RestirSettings& s) {
  return {
      {"correction",
       choice(s.correction, {"exact", "lagging", "basic"}),
       "What keeps the mean. exact: shadow rays in the weights, no history after geometry has moved; lagging: the "
       "same, but histories survive moving geometry; basic: no shadow rays in the weights, darker in shadows",
       {.biases = true}},
      {"feedback", choice(s.feedback, {"temporal", "spatial"}),
       "What the next frame reuses: the reservoirs before or after the reuse of neighbouring pixels"},
      {"cap",
       &s.cap,
       "Most frames that a reservoir's history counts for; 0: no reuse of earlier frames",
       {.min = 0, .max = 1000}},
      {"neighbours",
       &s.neighbours,
       "Neighbouring pixels whose reservoirs each pixel reuses per frame, with two shadow rays each; 0: none",
       {.min = 0, .max = kMostReuseNeighbours}},
      {"radius", &s.radius, "Largest distance of these neighbours", {.min = 1, .max = 1000, .unit = "pixels"}},
  };
}

}  // namespace relume
