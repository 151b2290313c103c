#include "techniques/guiding/directional_quadtree/settings.h"

namespace relume {

SettingList describe(DirectionalQuadtreeSettings& s) {
  return {
      {"bits", choice(s.bits, {"32", "64", "96", "128"}),
       "Bits of a region's quadtree; more bits give finer directions"},
      {"bsdf-fraction",
       &s.bsdf_fraction,
       "Fraction of directions sampled from the BSDF instead of the quadtree",
       {.min = 0.01, .max = 1}},
      {"learn-fraction", &s.learn_fraction,
       "Learn in each region the fraction of directions from the BSDF that gives the least noise; starts from "
       "bsdf-fraction"},
      {"candidates",
       &s.candidates,
       "Directions drawn at a glossy vertex, of which one is kept in proportion to BSDF times quadtree; 1: no "
       "resampling",
       {.min = 1, .max = 8}},
      {"migrations", &s.migrations, "Maximum number of leaves that a quadtree moves per frame", {.min = 1, .max = 32}},
      {"stability",
       &s.stability,
       "A leaf is split only if this fraction of its sum exceeds the sum of the node joined to free its bits",
       {.min = 0.001, .max = 1}},
      {"pool",
       &s.pool,
       "A region with fewer samples per frame than this also learns from those of its face neighbours and of the other "
       "leaves of its parent; 0: from its own only, as in the paper",
       {.min = 0, .max = 1 << 24}},
      {"memory",
       &s.memory,
       "Approximate number of earlier frames with samples that still count; 0: none, as in the paper",
       {.min = 0, .max = 1000}},
      {"spread",
       &s.spread,
       "Fraction of a leaf's sum that is also added to the leaves around it; 0: none, as in the paper",
       {.min = 0, .max = 8}},
      {"sampling", choice(s.sampling, {"bottom-up", "stratified"}),
       "Direction sampling: bottom-up from a random leaf, or top-down, which keeps low-discrepancy numbers well "
       "distributed"},
      {"importance", &s.importance,
       "Also guide the light subpaths of --estimator light, bdpt and vcm, by second quadtrees, which learn importance "
       "from camera subpaths"},
      {"view",
       &s.view,
       "Fill the layer \"directions\" with the guiding density at one point, beside the light that arrives there",
       {.resets_history = false}},
      {"view-x",
       &s.view_x,
       "Horizontal position of that point, as a fraction of the image width",
       {.min = 0, .max = 1, .resets_history = false}},
      {"view-y",
       &s.view_y,
       "Vertical position of that point, as a fraction of the image height",
       {.min = 0, .max = 1, .resets_history = false}},
  };
}

}  // namespace relume
