#include "techniques/denoise/svgf/settings.h"

namespace relume {

SettingList describe(SvgfSettings& s) {
  SettingList list = {
      {"levels",
       &s.levels,
       "Filter passes, each twice as wide as the one before",
       {.min = 0, .max = 5, .biases = true}},
      {"light-tolerance",
       &s.light_tolerance,
       "Luminance difference between pixels that the filter tolerates, in standard deviations of the noise",
       {.min = 0.01, .max = 1000, .biases = true}},
      {"plane-tolerance",
       &s.plane_tolerance,
       "Distance from a pixel's plane that the filter tolerates, as a fraction of the distance between the pixels",
       {.min = 0.001, .max = 1000, .biases = true}},
  };
  add_settings(list, s.history);
  return list;
}

}  // namespace relume
