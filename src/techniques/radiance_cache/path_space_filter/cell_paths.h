// What caches in a hash grid have in common where they trace paths: their output, and random numbers of their own.
#pragma once

#include "techniques/radiance_cache/path_space_filter/filtered_pixel.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Random numbers of a pixel and frame for keys, apart from those of the path. `purpose` keeps them apart.
RELUME_HD inline float filter_random(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t purpose) {
  const uint32_t frame = hash(index.seed, index.frame, index.sample, 0x2545f491u + purpose);
  return to_unit_float(hash(frame, x, y));
}
RELUME_HD inline Vec2 filter_random_2d(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t purpose) {
  return {filter_random(index, x, y, 2 * purpose + 0x10000u), filter_random(index, x, y, 2 * purpose + 0x10001u)};
}

/// Fills the cells. `Cache` has a path policy,
///   Policy
///   policy(index, x, y)
/// which steers paths, gives their samples to the cells when they are finished, and has
///   pixel()        what the pixel is made of once the cells have all samples
template <typename Cache>
struct CellsOutput {
  using Policy = typename Cache::Policy;

  Cache cache;
  View<FilteredPixel> pixels;

  RELUME_HD Policy policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t /*pixel*/) const {
    return cache.policy(index, x, y);
  }
  RELUME_HD void finish(uint32_t pixel, Policy& policy, const PathState&) const { pixels[pixel] = policy.pixel(); }
  RELUME_HD void leave_out(uint32_t pixel) const { pixels[pixel] = {}; }
};

/// Traces one path a pixel and fills the cells.
template <typename Cache>
using CellPathsKernel = PathKernel<CellsOutput<Cache>>;

}  // namespace relume
