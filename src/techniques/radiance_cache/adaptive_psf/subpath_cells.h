// Path space filtering of bidirectional estimators, with or without survival. The strategies that sample the filtered
// vertex from the camera share it, so the sum of their light is the sample for its cell. Splats have no cell: they stay
// beside it, in the pixel that they reach.
//
// The weights of both sides are those of the sample's own densities, so they sum to one for every path. Because a cell
// averages over the pixels that it covers, weights count the camera's strategies once per covered pixel
// (BdptContext::light_paths). The part of a cell depends on the density with which the camera finds the vertex.
// Neighbours share it approximately.
//
// With reservoirs of direct light, no strategy finds that of primary hits (BdptContext::first_scatters), so no cell has
// it. With reservoirs of indirect light, cells lack the light of their samples (sampled_subpath_cells.h).
#pragma once

#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"
#include "techniques/transport/bdpt/bdpt.h"
#include "techniques/transport/vcm/vcm.h"

namespace relume {

/// Output of camera subpaths that fill cells, as SubpathRadiance.
struct SubpathCells {
  AdaptiveFilterContext cache;
  View<FilteredPixel> pixels;
  View<Rgb> radiance;                ///< cleared for splats and the light of reservoirs
  View<float> scatter_chances = {};  ///< kScatterChances; only with reservoirs, else empty

  RELUME_HD AdaptiveVertex policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t /*pixel*/) const {
    return cache.policy(index, x, y);
  }
  RELUME_HD void finish(uint32_t pixel, AdaptiveVertex& policy, const Rgb& /*seen*/) const {
    pixels[pixel] = policy.pixel();
    prepare(pixel, policy.scatter_chance());
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    pixels[pixel] = {};
    prepare(pixel, 1.0f);
  }

 private:
  /// Prepares the pixel for splats and reservoirs.
  RELUME_HD void prepare(uint32_t pixel, float scatter_chance) const {
    radiance[pixel] = Rgb(0);
    if (!scatter_chances.empty()) scatter_chances[pixel] = scatter_chance;
  }
};

}  // namespace relume
