#include "techniques/denoise/svgf/settings.h"

namespace relume {

SettingList describe(SvgfSettings& s) {
  SettingList list = {
      {"levels",
       &s.levels,
       "Passes of the filter, each twice as wide as the one before",
       {.min = 0, .max = 5, .biases = true}},
      {"light-tolerance",
       &s.light_tolerance,
       "Standard deviations of its noise by which light may differ from pixel to pixel and still be averaged",
       {.min = 0.01, .max = 1000, .biases = true}},
      {"plane-tolerance",
       &s.plane_tolerance,
       "How far off a pixel's plane others may lie, as a share of how far they are apart",
       {.min = 0.001, .max = 1000, .biases = true}},
  };
  add_settings(list, s.history);
  return list;
}

}  // namespace relume
