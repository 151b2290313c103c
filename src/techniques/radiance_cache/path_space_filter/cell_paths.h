// What caches in a hash grid have in common where they trace paths: how they watch them, and random numbers of their
// own.
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

/// Fills the cells. `Cache` makes what watches a path,
///   observer(index, x, y)
/// an observer of trace_path() with
///   finish(path)   when the path has ended: gives its samples to the cells
///   pixel()        what the pixel is made of once the cells have all samples
template <typename Cache>
struct CellObservation {
  Cache cache;
  View<FilteredPixel> pixels;

  RELUME_HD auto observer(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t /*pixel*/) const {
    return cache.observer(index, x, y);
  }
  template <typename Observer>
  RELUME_HD void finish(uint32_t pixel, Observer& watcher, PathState& path) const {
    watcher.finish(path);
    pixels[pixel] = watcher.pixel();
  }
  RELUME_HD void leave_out(uint32_t pixel) const { pixels[pixel] = {}; }
};

/// Traces one path a pixel and fills the cells.
template <typename Cache>
using CellPathsKernel = ObservedPathKernel<CellObservation<Cache>>;

}  // namespace relume
