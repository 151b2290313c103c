#include "techniques/spatial/hash_grid/settings.h"

namespace relume {

SettingList describe(HashGridSettings& s) {
  return {
      {"cell-size",
       &s.cell_size,
       "Edge of a cell; larger cells have less noise and blur more",
       {.min = 0.5, .max = 1024, .unit = "pixels", .biases = true}},
      {"jitter",
       &s.jitter,
       "Move points at random by up to half a cell before they choose one: noise in place of edges between cells",
       {.biases = true}},
      {"normal-bins",
       &s.normal_bins,
       "Steps of a normal's component between 0 and 1 that cells tell apart; 0: cells mix all orientations, and light "
       "leaks around edges",
       {.min = 0, .max = 16, .biases = true}},
      {"direction-bins",
       &s.direction_bins,
       "The same for the direction to the viewer at glossy surfaces; 0: cells mix all directions",
       {.min = 0, .max = 16, .biases = true}},
      {"max-samples",
       &s.max_count,
       "Samples after which a cell begins to forget: the more, the less noise, and the slower it follows changes",
       {.min = 1, .max = 1 << 24, .biases = true}},
      {"max-age", &s.max_age, "Frames that a cell is kept without samples", {.min = 1, .max = 65535, .unit = "frames"}},
      {"min-samples",
       &s.min_count,
       "Samples below which a cell is thin: its variance is unknown, and its mean is replaced as thin-cells says",
       {.min = 1, .max = 4096, .biases = true}},
      {"inherited-samples",
       &s.inherited_count,
       "Most samples that a new cell takes over from the cell of the next level at its place, when the camera comes "
       "nearer or goes away; 0: none",
       {.min = 0, .max = 1 << 24, .biases = true}},
      {"thin-cells",
       choice(s.thin_cells, {"keep", "coarser", "neighbours"}),
       "What replaces a thin cell: nothing, up to three coarser levels, or the eight nearest cells",
       {.biases = true}},
      {"clamp",
       &s.clamp,
       "Cut samples to this multiple of their cell's mean, against fireflies; 0: never",
       {.min = 0, .max = 1e6, .biases = true}},
      {"change-detection",
       &s.change_detection,
       "Standard errors by which samples must leave a cell's history twice in a row to discard it; 0: never",
       {.min = 0, .max = 100, .biases = true}},
      {"max-cells",
       &s.max_cells,
       "Largest size of the table between frames; the oldest cells beyond it are discarded. 0: four slots for each "
       "pixel and each vertex of its path that has cells, within an eighth of the machine's memory",
       {.min = 0, .max = kMostSlots, .biases = true}},
  };
}

}  // namespace relume
