#include "techniques/light_sampling/adaptive_tiles/settings.h"

namespace relume {

SettingList describe(AdaptiveTilesSettings& s) {
  return {
      {"local",
       &s.local,
       "Fraction of samples drawn from the list of the screen tile, otherwise from all lights",
       {.min = 0, .max = 0.95}},
      {"feedback",
       &s.feedback,
       "Weight of the use of lights in the last frames for samples from all lights, otherwise by power",
       {.min = 0, .max = 0.95}},
      {"tile-size", &s.tile_size, "Edge of a tile", {.min = 2, .max = 64, .unit = "pixels"}},
      {"list-size",
       &s.list_size,
       "Entries of a tile's list, of which a light may have several",
       {.min = 16, .max = 512}},
      {"radius",
       &s.radius,
       "Distance from the tile's centre, along each axis, of the pixels that fill the rest of its list",
       {.min = 0, .max = 256, .unit = "pixels"}},
      {"depth-tolerance",
       &s.depth_tolerance,
       "Surface points take lights from a tile's list if their distance is within that of its surfaces up to this "
       "factor",
       {.min = 1, .max = 1e6}},
      {"jitter", &s.jitter, "Shift the tiles in each frame; hides their borders"},
      {"longest-epoch",
       &s.longest_epoch,
       "Maximum length of the epochs of 1, 2, 4, ... frames that share one set of lists while nothing changes and a "
       "history accumulates; 1: lists change in every frame",
       {.min = 1, .max = 1 << 20}},
  };
}

}  // namespace relume
