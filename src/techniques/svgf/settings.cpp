#include "techniques/svgf/settings.h"

namespace relume {

SettingList describe(SvgfSettings& s) {
  return {
      {"max-history",
       &s.max_history,
       "Samples that the light at a surface is averaged over at most while the camera moves",
       {.min = 1, .max = 1024, .biases = true}},
      {"max-history-changed",
       &s.max_history_changed,
       "The same while objects or lights move",
       {.min = 1, .max = 1024, .biases = true}},
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
      {"newest",
       &s.newest,
       "Weight of a frame in the picture while something moves; below 1 edges are smooth",
       {.min = 0.01, .max = 1, .biases = true}},
  };
}

}  // namespace relume
