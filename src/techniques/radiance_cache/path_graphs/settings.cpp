#include "techniques/radiance_cache/path_graphs/settings.h"

namespace relume {

SettingList describe(PathGraphSettings& s) {
  return {
      {"variance-constant",
       &s.variance_constant,
       "Variance that a path may bring into its pixel before a cell takes over: the more, the less bias and the more "
       "noise; 0: cells show everything",
       {.min = 0, .max = 1e12, .biases = true}},
      {"variance", choice(s.variance, {"relative", "absolute"}),
       "What the constant is: a multiple of the squared radiance that the pixel's first cell shows, or the variance "
       "itself"},
      {"feed",
       &s.feed,
       "Share of the paths that continue after a cell has taken over, to feed the cells of the vertices beyond; if not "
       "0, at least one path of a pixel in 4096 does",
       {.min = 0, .max = 1}},
      {"deep-coarsening",
       &s.deep_coarsening,
       "Doublings of the edge of cells beyond a path's first vertex: nobody sees them directly, and of small ones few "
       "would know anything",
       {.min = 0, .max = 4, .biases = true}},
  };
}

}  // namespace relume
