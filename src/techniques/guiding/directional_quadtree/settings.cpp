#include "techniques/guiding/directional_quadtree/settings.h"

namespace relume {

SettingList describe(DirectionalQuadtreeSettings& s) {
  return {
      {"bits", choice(s.bits, {"32", "64", "96", "128"}), "Size of a region's quadtree: more bits, finer directions"},
      {"bsdf-fraction",
       &s.bsdf_fraction,
       "Share of directions that follow the material instead of the quadtree",
       {.min = 0.01, .max = 1}},
      {"migrations", &s.migrations, "Leaves that a quadtree may move in a frame", {.min = 1, .max = 32}},
      {"stability",
       &s.stability,
       "A leaf is split if this share of it exceeds what gives way to it",
       {.min = 0.001, .max = 1}},
      {"memory",
       &s.memory,
       "Earlier frames in which a region had samples that still count, roughly; 0: none, as in the paper",
       {.min = 0, .max = 1000}},
      {"spread",
       &s.spread,
       "Share of what a leaf found that counts for the leaves around it too; 0: none, as in the paper",
       {.min = 0, .max = 8}},
      {"sampling", choice(s.sampling, {"bottom-up", "stratified"}),
       "How directions are drawn: a leaf first, or from the root down so that well spread numbers stay spread"},
      {"view",
       &s.view,
       "Show in the buffer \"directions\" what guiding knows of one point, beside the light that comes in there",
       {.resets_history = false}},
      {"view-x",
       &s.view_x,
       "That point, as a share of the image's width",
       {.min = 0, .max = 1, .resets_history = false}},
      {"view-y", &s.view_y, "The same of its height", {.min = 0, .max = 1, .resets_history = false}},
  };
}

}  // namespace relume
