// Shared parts of caches that fill a hash grid: the output of their paths and random numbers for keys.
#pragma once

#include "techniques/radiance_cache/path_space_filter/filtered_pixel.h"
#include "techniques/transport/path/chain_output.h"
#include "techniques/transport/path/first_scatter.h"
#include "techniques/transport/path/optional_output.h"
#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/recording_output.h"

namespace relume {

/// Random numbers of a pixel and frame that are independent of the path's. `purpose` distinguishes uses.
RELUME_HD inline float filter_random(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t purpose) {
  const uint32_t frame = hash(index.seed, index.frame, index.sample, 0x2545f491u + purpose);
  return to_unit_float(hash(frame, x, y));
}
RELUME_HD inline Vec2 filter_random_2d(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t purpose) {
  return {filter_random(index, x, y, 2 * purpose + 0x10000u), filter_random(index, x, y, 2 * purpose + 0x10001u)};
}

/// Output of paths that fill cells. `Cache` has a path policy,
///   Policy
///   policy(index, x, y)
/// which modifies paths and adds their samples to cells in finished(). It has
///   pixel()             the FilteredPixel for the pass that reads the cells
///   scatter_chance()    the pixel's element of kScatterChances
template <typename Cache>
struct CellsOutput {
  using Policy = typename Cache::Policy;

  Cache cache;
  View<FilteredPixel> pixels;
  View<float> scatter_chances = {};  ///< only if reservoirs add the direct light of primary hits; else empty
  View<Rgb> radiance = {};           ///< only if reservoirs add light, for which it is cleared; else empty

  RELUME_HD Policy policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t /*pixel*/) const {
    return cache.policy(index, x, y);
  }
  RELUME_HD void finish(uint32_t pixel, Policy& policy, const PathState&) const {
    pixels[pixel] = policy.pixel();
    prepare(pixel, policy.scatter_chance());
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    pixels[pixel] = {};
    prepare(pixel, 1.0f);
  }

 private:
  /// Prepares the pixel for reservoirs.
  RELUME_HD void prepare(uint32_t pixel, float scatter_chance) const {
    if (!scatter_chances.empty()) scatter_chances[pixel] = scatter_chance;
    if (!radiance.empty()) radiance[pixel] = Rgb(0);
  }
};

/// Output of first scattering events, for paths that leave the direct light of primary hits to reservoirs. The kernels
/// of all paths that fill cells contain it: kernels of their own would double the device code of caches.
using ReservoirScatterOutput = OptionalOutput<FirstScatterOutput>;

/// Traces one path per pixel and fills the cells.
template <typename Cache>
using CellPathsKernel = PathKernel<CellsOutput<Cache>, ReservoirScatterOutput>;

/// Traces one path per pixel, fills the cells, and records samples for regions and states for chains. Either kind of
/// records may have no vertices. One kernel serves both, because each is compiled for hosts and devices.
template <typename Cache>
using RecordedCellPathsKernel =
    PathKernel<CachedRecordingOutput, CachedChainOutput, CellsOutput<Cache>, ReservoirScatterOutput>;

}  // namespace relume
