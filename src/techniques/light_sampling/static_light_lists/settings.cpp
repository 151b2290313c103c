#include "techniques/light_sampling/static_light_lists/settings.h"

#include "techniques/light_sampling/light_selection/weighed_lights.h"

namespace relume {

SettingList describe(StaticLightListsSettings& s) {
  return {
      {"cell-size",
       &s.cell_size,
       "Edge of a cell; 0: a 24th of the scene's longest side",
       {.min = 0, .max = 1e6, .unit = "m"}},
      {"rays",
       &s.rays,
       "Rays that look for lights from each cell; a 64th of that for each light, and two at least, if that is more",
       {.min = 64, .max = 1 << 20}},
      {"max-lights",
       &s.max_lights,
       "Lights that are weighed at a point, at most; longer lists are strided",
       {.min = 1, .max = kMaxWeighedLights}},
      {"exploration",
       &s.exploration,
       "Share of samples among all lights, in proportion to power, for what the lists miss",
       {.min = 0.001, .max = 1}},
  };
}

}  // namespace relume
