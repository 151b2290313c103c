// Results of paths for the pass that computes pixels from cells.
#pragma once

#include "techniques/radiance_cache/path_space_filter/finer_cell.h"
#include "techniques/spatial/hash_grid/hash_grid.h"
#include "techniques/transport/path/path.h"

namespace relume {

/// Layer of the cells that hold only light from specular lobes.
inline constexpr uint16_t kSpecularLayer = 1;

/// Result of a pixel's path. If `split`, the diffuse and the specular lobes of the vertex have a cell each.
struct FilteredPixel {
  Rgb unfiltered{0};        ///< radiance outside the cell
  Rgb factor{0};            ///< factor of the (diffuse) cell's mean: throughput · albedo
  Rgb specular_factor{0};   ///< factor of the specular cell's mean
  Rgb traced{0};            ///< the path's own estimate of the sum of factor · mean
  Rgb seen{0};              ///< emission at the end of the camera ray; part of `unfiltered`
  CellPoint point;          ///< inputs of the (diffuse) cell's key
  uint32_t slot = kNoCell;  ///< slot of the (diffuse) cell, if known
  uint32_t specular_slot = kNoCell;
  uint32_t specular_direction = 0;  ///< direction and roughness in the key of the specular cell
  uint32_t finer = 0;               ///< finer_offset() of the finer cell; 0: none
  float blend = 1;                  ///< share of the cell; the rest is `traced`
  float survival = 1;               ///< probability of following the path
  uint16_t termination = 0;         ///< bounce, from 1, at which the path's contribution ended; 0: not recorded
  bool filtered = false;            ///< whether the path has a filtered vertex
  bool culled = false;              ///< whether the path was not followed; the pixel shows only the cell
  bool divided = false;             ///< whether the vertex has delta lobes, whose light only a path samples
  bool split = false;               ///< whether there is a specular cell

  /// Inputs of the specular cell's key.
  RELUME_HD CellPoint specular_point() const {
    CellPoint p = point;
    p.direction = specular_direction;
    p.layer = kSpecularLayer;
    return p;
  }
};
static_assert(sizeof(FilteredPixel) == 116, "README.md states the bytes per pixel");

}  // namespace relume
