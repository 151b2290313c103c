#include "techniques/radiance_cache/path_graphs/settings.h"

namespace relume {

SettingList describe(PathGraphSettings& s) {
  return {
      {"variance-constant",
       &s.variance_constant,
       "Variance that a path may add to its pixel before a cell replaces the rest: more gives less bias and more "
       "noise; 0: cells only",
       {.min = 0, .max = 1e12, .biases = true}},
      {"variance", choice(s.variance, {"relative", "absolute"}),
       "Unit of the constant: the squared radiance shown by the pixel's first cell, or absolute variance"},
      {"feed",
       &s.feed,
       "Fraction of paths that continue after a cell replaced them, to fill the cells of later vertices; at least "
       "1/4096 unless 0",
       {.min = 0, .max = 1}},
      {"deep-coarsening",
       &s.deep_coarsening,
       "Doublings of the cell size beyond a path's first vertex, where cells are not seen directly and small ones get "
       "too few samples",
       {.min = 0, .max = 4, .biases = true}},
      {"guards",
       &s.guards,
       "Let paths pass cells beyond their first vertex that are larger than the segment that leads there, or than the "
       "path's ray cone: less blur and leaking, more rays and noise",
       {.biases = true}},
  };
}

}  // namespace relume
