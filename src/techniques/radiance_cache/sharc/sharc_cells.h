// Cells of the spatially hashed radiance cache, as its update paths and the camera paths see them.
#pragma once

#include "techniques/radiance_cache/path_space_filter/cell_paths.h"
#include "techniques/radiance_cache/path_space_filter/demodulate.h"

namespace relume {

struct SharcCells {
  HashGridView grid;
  float narrow_alpha = 0.04f;  ///< α below which lobes count as specular

  /// Whether a vertex may have a cell. Cells hold no light of delta lobes, and would average over wavelengths.
  RELUME_HD static bool may_hold(const SurfacePoint& sp, const PathState& path) {
    return !path.dispersed && !has_delta(sp.bsdf);
  }

  /// The inputs of the key of `sp`; `u` in [0, 1)² is for the jitter. Geometric normals, because normal maps vary
  /// within a cell.
  RELUME_HD CellPoint point(const SurfacePoint& sp, const Vec2& u) const {
    const CellKeys& keys = grid.keys;
    return {keys.jittered(sp.position, sp.ng, u), CellKeys::bins(sp.ng, keys.normal_bins), 0, 0, 0};
  }
};

}  // namespace relume
