// What paths leave behind for the pass that puts pixels together.
#pragma once

#include "techniques/spatial/hash_grid/hash_grid.h"
#include "techniques/transport/path/path.h"

namespace relume {

/// What a pixel leaves to the pass that reads the cells.
struct FilteredPixel {
  Rgb unfiltered{0};         ///< radiance that the filter does not touch
  Rgb factor{0};             ///< what the cell's mean is multiplied with: throughput and albedo
  Rgb traced{0};             ///< this frame's own estimate of what the cell stands for
  Rgb seen{0};               ///< emission at the end of the camera ray; part of `unfiltered`
  CellPoint point;           ///< where in the grid
  uint32_t slot = kNoCell;   ///< of the cell, if it is known to have one
  float blend = 1;           ///< share of the cell; the rest is traced
  float survival = 1;        ///< probability with which the path was followed
  uint16_t termination = 0;  ///< bounce, from 1, at which the path ceased to count; 0: nothing to trace
  bool filtered = false;     ///< there is a vertex to filter at
  bool culled = false;       ///< no path was followed: the cell alone counts
  bool divided = false;      ///< delta lobes go past the cell: without a path, their light would be missing
};

}  // namespace relume
