#include "techniques/radiance_cache/sharc/settings.h"

namespace relume {
namespace {

/// Settings of the paths.
SettingList describe_paths(SharcSettings& s) {
  return {
      {"update", choice(s.update, {"sparse", "all"}),
       "Pixels that trace an update path for the cells: one of each block of 5 × 5 pixels per frame, or all"},
      {"end",
       choice(s.end, {"footprint", "variance"}),
       "Cells in which camera paths end. footprint: those smaller than the segment that leads there and than the cone "
       "of the last rough lobe; variance: of these, only cells whose samples vary little (sharc.variance)",
       {.biases = true}},
      {"variance",
       &s.variance,
       "With end variance: maximum variance of a cell's samples, in units of the cell's squared mean; less gives less "
       "blur, more rays and more noise",
       {.min = 0, .max = 1e6, .biases = true}},
      {"feedback",
       &s.feedback,
       "Let update paths end in known cells, which propagates light over any number of bounces; off: cells hold the "
       "light of propagation-depth bounces only, so images are too dark",
       {.biases = true}},
      {"propagation-depth",
       &s.propagation_depth,
       "Cells of an update path that wait for light of its later vertices; without feedback, also the number of these "
       "vertices, with that of the cell",
       {.min = 2, .max = 8, .biases = true}},
      {"clamp",
       &s.clamp,
       "Against fireflies: maximum light from later vertices, as a multiple of the cell's mean; half of it at two "
       "samples, all of it from 12 on; 0: off",
       {.min = 0, .max = 1e6, .biases = true}},
  };
}

}  // namespace

SettingList describe(SharcSettings& s) {
  SettingList list = describe_paths(s);
  const SettingList cells{
      {"cell-size",
       &s.cell_size,
       "Edge length of a cell at the camera's distance; larger cells have less noise and more blur",
       {.min = 0.5, .max = 1024, .unit = "pixels", .biases = true}},
      {"jitter",
       &s.jitter,
       "Move each point at random by up to half a cell before its cell is looked up: noise instead of cell borders",
       {.biases = true}},
      {"normal-bins",
       &s.normal_bins,
       "Number of steps from 0 to 1 in each component of the geometric normal; every step has cells of its own; 0: "
       "cells mix all orientations",
       {.min = 0, .max = 16, .biases = true}},
      {"min-roughness",
       &s.min_roughness,
       "Minimum roughness of the dominant lobe of surfaces with cells",
       {.min = 0, .max = 1, .biases = true}},
      {"frames",
       &s.frames,
       "Frames that a cell averages; a younger cell averages half of its frames. More give less noise and a slower "
       "response to changes",
       {.min = 1, .max = 1024, .unit = "frames", .biases = true}},
      {"min-samples",
       &s.min_samples,
       "Minimum number of samples of a known cell; paths end in known cells only",
       {.min = 1, .max = 4096, .biases = true}},
      {"max-age",
       &s.max_age,
       "Frames for which a cell is kept without samples",
       {.min = 1, .max = 65535, .unit = "frames"}},
      {"max-cells",
       &s.max_cells,
       "Maximum number of table slots kept from frame to frame; the oldest cells beyond it are discarded. 0: several "
       "slots per pixel, within an eighth of the machine's memory",
       {.min = 0, .max = kMostSlots, .biases = true}},
  };
  list.insert(list.end(), cells.begin(), cells.end());
  return list;
}

PathSpaceFilterSettings cell_settings(const SharcSettings& s) {
  PathSpaceFilterSettings cells;
  cells.grid.cell_size = s.cell_size;
  cells.grid.jitter = s.jitter;
  cells.grid.normal_bins = s.normal_bins;
  cells.grid.max_count = 1 << 24;  // `frames` is the limit
  cells.grid.max_frames = s.frames;
  cells.grid.max_age = s.max_age;
  cells.grid.min_count = s.min_samples;
  cells.grid.undersampled_cells = UndersampledCells::keep;
  cells.grid.change_detection = 0;
  cells.grid.max_cells = s.max_cells;
  cells.min_roughness = s.min_roughness;
  return cells;
}

}  // namespace relume
