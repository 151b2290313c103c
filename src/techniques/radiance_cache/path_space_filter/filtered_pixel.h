// Results of paths for the pass that computes pixels from cells.
#pragma once

#include "techniques/spatial/hash_grid/hash_grid.h"
#include "techniques/transport/path/path.h"

namespace relume {

/// Result of a pixel's path.
struct FilteredPixel {
  Rgb unfiltered{0};         ///< radiance outside the cell
  Rgb factor{0};             ///< factor of the cell's mean: throughput · albedo
  Rgb traced{0};             ///< the path's own estimate of factor · mean
  Rgb seen{0};               ///< emission at the end of the camera ray; part of `unfiltered`
  CellPoint point;           ///< inputs of the cell's key
  uint32_t slot = kNoCell;   ///< slot of the cell, if known
  float blend = 1;           ///< share of the cell; the rest is `traced`
  float survival = 1;        ///< probability of following the path
  uint16_t termination = 0;  ///< bounce, from 1, at which the path's contribution ended; 0: not recorded
  bool filtered = false;     ///< whether the path has a filtered vertex
  bool culled = false;       ///< whether the path was not followed; the pixel shows only the cell
  bool divided = false;      ///< whether the vertex has delta lobes, whose light only a path samples
};
static_assert(sizeof(FilteredPixel) == 92, "README.md states the bytes per pixel");

}  // namespace relume
