#include "techniques/light_sampling/static_light_lists/settings.h"

#include "techniques/light_sampling/light_selection/weighed_lights.h"

namespace relume {

SettingList describe(StaticLightListsSettings& s) {
  return {
      {"cell-size",
       &s.cell_size,
       "Cell size; 0: 1/24 of the longest side of the scene",
       {.min = 0, .max = 1e6, .unit = "m"}},
      {"rays",
       &s.rays,
       "Visibility rays per cell, but at least 1/64 of this number (and at least two) per light",
       {.min = 64, .max = 1 << 20}},
      {"max-lights",
       &s.max_lights,
       "Maximum number of lights weighted per choice; longer lists are strided",
       {.min = 1, .max = kMaxWeighedLights}},
      {"exploration",
       &s.exploration,
       "Fraction of samples drawn from all lights by power, to reach lights that the lists miss",
       {.min = 0.001, .max = 1}},
      {"visibility", choice(s.visibility, {"rays", "sets"}),
       "Source of the lists: random rays, or the visible sets of the scene, which the built-in bases have"},
  };
}

}  // namespace relume
