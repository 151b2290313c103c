// Results of paths for the pass that computes pixels from cells.
#pragma once

#include "techniques/radiance_cache/path_space_filter/finer_cell.h"
#include "techniques/spatial/hash_grid/hash_grid.h"
#include "techniques/transport/path/path.h"

namespace relume {

/// Flag in the layer of the cells that hold only light from specular lobes.
inline constexpr uint16_t kSpecularLayer = 1;
/// Flag in the layer of cells of vertices behind others (FilterContext::separates_primary()).
inline constexpr uint16_t kBehindLayer = 0x4000;

/// Result of a pixel's path. If `split`, the diffuse and the specular lobes of the vertex have a cell each.
struct FilteredPixel {
  Rgb unfiltered{0};         ///< radiance outside the cell
  Rgb factor{0};             ///< factor of the (diffuse) cell's mean: throughput · albedo
  Rgb traced{0};             ///< the path's own estimate of the sum of factor · mean
  Rgb seen{0};               ///< emission at the end of the camera ray; part of `unfiltered`
  CellPoint point;           ///< inputs of the (diffuse) cell's key
  uint32_t slot = kNoCell;   ///< slot of the (diffuse) cell, if known
  float blend = 1;           ///< share of the cell; the rest is `traced`
  float survival = 1;        ///< probability of following the path
  uint16_t termination = 0;  ///< bounce, from 1, at which the path's contribution ended; 0: not recorded
  bool filtered = false;     ///< whether the path has a filtered vertex
  bool culled = false;       ///< whether the path was not followed; the pixel shows only the cell
  bool divided = false;      ///< whether the vertex has delta lobes, whose light only a path samples
  bool split = false;        ///< whether there is a specular cell
};
static_assert(sizeof(FilteredPixel) == 92, "README.md states the bytes per pixel");

/// The other cells of a filtered pixel, and the parts of its sample. Pixels have them only if a setting needs them.
struct OtherCells {
  Rgb specular_factor{0};  ///< factor of the specular cell's mean
  uint32_t specular_slot = kNoCell;
  uint32_t specular_direction = 0;  ///< direction and roughness in the key of the specular cell
  uint32_t finer = 0;               ///< finer_offset() of the finer cell
  // While the path is traced, with split cells:
  Rgb specular{0};     ///< part of the sample from specular lobes
  Rgb share{0};        ///< share of specular lobes in the BSDF along the sampled direction
  Rgb before{0};       ///< radiance before the path left the vertex
  Rgb to_diffuse{1};   ///< ratio of the demodulations of diffuse and of all lobes
  Rgb to_specular{1};  ///< the same for specular lobes

  /// Inputs of the specular cell's key; `diffuse`: those of the diffuse cell's.
  RELUME_HD CellPoint specular_point(const CellPoint& diffuse) const {
    CellPoint p = diffuse;
    p.direction = specular_direction;
    p.layer = static_cast<uint16_t>(p.layer | kSpecularLayer);
    return p;
  }
};
static_assert(sizeof(OtherCells) == 84, "README.md states the bytes per pixel");

}  // namespace relume
