#include "techniques/spatial/hash_grid/settings.h"

namespace relume {
namespace {

/// Settings of cells with few samples.
SettingList describe_undersampled(HashGridSettings& s) {
  return {
      {"min-samples",
       &s.min_count,
       "Samples below which a cell is undersampled: its variance is unknown, and undersampled-cells chooses what "
       "replaces its mean",
       {.min = 1, .max = 4096, .biases = true}},
      {"inherited-samples",
       &s.inherited_count,
       "Maximum number of samples that a new cell inherits from the next level when the camera moves closer or away; "
       "0: none",
       {.min = 0, .max = 1 << 24, .biases = true}},
      {"undersampled-cells",
       choice(s.undersampled_cells, {"keep", "coarser", "neighbours", "neighbours+coarser"}),
       "Replacement for an undersampled cell: none, up to three coarser levels, the eight nearest cells, or these and "
       "then coarser levels with half as many normals",
       {.biases = true}},
      {"coarser-levels",
       &s.coarser_levels,
       "Maximum number of coarser levels with undersampled-cells neighbours+coarser; light leaks one cell further with "
       "1, three with 2, seven with 3",
       {.min = 1, .max = 3, .biases = true}},
  };
}

/// Settings of discarding samples and cells.
SettingList describe_limits(HashGridSettings& s) {
  return {
      {"clamp",
       &s.clamp,
       "Clamp samples to this multiple of their cell's mean, against fireflies; 0: off",
       {.min = 0, .max = 1e6, .biases = true}},
      {"change-detection",
       &s.change_detection,
       "Standard errors by which samples must deviate from a cell's history, twice in a row, to discard it; 0: never",
       {.min = 0, .max = 100, .biases = true}},
      {"max-cells",
       &s.max_cells,
       "Maximum number of table slots kept from frame to frame; the oldest cells beyond it are discarded. 0: four "
       "slots per pixel and per path vertex with cells, within an eighth of the machine's memory",
       {.min = 0, .max = kMostSlots, .biases = true}},
  };
}

}  // namespace

SettingList describe(HashGridSettings& s) {
  SettingList list{
      {"cell-size",
       &s.cell_size,
       "Edge length of a cell; larger cells have less noise and more blur",
       {.min = 0.5, .max = 1024, .unit = "pixels", .biases = true}},
      {"jitter",
       &s.jitter,
       "Move each point at random by up to half a cell before its cell is looked up: noise instead of visible cell "
       "borders",
       {.biases = true}},
      {"normal-bins",
       &s.normal_bins,
       "Number of steps from 0 to 1 in each component of the normal; every step has cells of its own; 0: cells mix all "
       "orientations, and light leaks around edges",
       {.min = 0, .max = 16, .biases = true}},
      {"direction-bins",
       &s.direction_bins,
       "Number of steps from 0 to 1 in each component of the direction to the viewer, at glossy surfaces; 0: cells mix "
       "all directions",
       {.min = 0, .max = 16, .biases = true}},
      {"roughness-bins",
       &s.roughness_bins,
       "Number of steps from 0 to 1 in the roughness, averaged over a surface's lobes; every step has cells of its "
       "own; 0: cells mix glossy and matte texels",
       {.min = 0, .max = 16, .biases = true}},
      {"max-samples",
       &s.max_count,
       "Maximum number of samples in a cell's history; more gives less noise and a slower response to changes",
       {.min = 1, .max = 1 << 24, .biases = true}},
      {"max-age",
       &s.max_age,
       "Frames for which a cell is kept without samples",
       {.min = 1, .max = 65535, .unit = "frames"}},
  };
  for (const SettingList& more : {describe_undersampled(s), describe_limits(s)})
    list.insert(list.end(), more.begin(), more.end());
  return list;
}

}  // namespace relume
