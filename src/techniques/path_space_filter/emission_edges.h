// Emission that a camera ray meets is not filtered. Where something bright ends, one ray in a pixel sees all of it or
// nothing, and the noise of such pixels would outweigh whatever the filter removes elsewhere. They get more camera
// rays.
#pragma once

#include "techniques/path_space_filter/filtered_pixel.h"

namespace relume {

/// Finds pixels at the edges of something bright and measures how much of it they see.
struct EmissionEdges {
  /// Neighbours differ if their emission does by more than this multiple of the darkest one's radiance.
  static constexpr float kContrast = 4;

  PathContext context;
  SampleIndex index;
  View<const FilteredPixel> pixels;
  uint32_t rays = 0;  ///< for each such pixel; 0: none gets any
  uint32_t width = 0;
  uint32_t height = 0;

  /// Whether the neighbours of pixel (x, y) differ. Its own sample has no say, or what it saw would be counted more
  /// or less often than it deserves.
  RELUME_HD bool contains(const HashGridView& grid, uint32_t x, uint32_t y) const {
    float least = kInfinity;
    float most = 0;
    for (uint32_t k = 0; k < kNeighbours; ++k) {
      uint32_t i = 0;
      if (!neighbour(k, x, y, i)) continue;
      const float emission = luminance(pixels[i].seen);
      least = relume::min(least, emission);
      most = relume::max(most, emission);
    }
    if (!(most > least)) return false;
    float darkest = kInfinity;
    for (uint32_t k = 0; k < kNeighbours; ++k) {
      uint32_t i = 0;
      if (neighbour(k, x, y, i)) darkest = relume::min(darkest, luminance(shown(grid, pixels[i])));
    }
    return most - least > kContrast * darkest;
  }

  /// Mean emission of what pixel (x, y) sees. One sequence runs through all frames, as nothing here adapts.
  RELUME_HD Rgb emission(uint32_t x, uint32_t y) const {
    constexpr uint32_t kSalt = 0x5bd1e995u;
    Rgb sum(0);
    SurfacePoint points[2];
    points[1].bsdf.lobe_count = 0;  // the camera
    NoObserver observer;
    for (uint32_t k = 0; k < rays; ++k) {
      const uint32_t sample = (index.independent ? index.frame : index.sample) * rays + k;
      Sampler sampler = Sampler::sequence(index.seed ^ kSalt, x, y, sample);
      PathState path = start_path(context, x, y, sampler);
      points[1].position = path.ray.origin;
      const Hit hit = intersect(context.scene.accel, path.ray, sampler.camera_ray_id());
      arrive(context, hit, points[1], points[0], path, observer);
      sum += path.radiance;
    }
    return sum / static_cast<float>(rays);
  }

 private:
  static constexpr uint32_t kNeighbours = 8;

  /// False outside of the picture.
  RELUME_HD bool neighbour(uint32_t k, uint32_t x, uint32_t y, uint32_t& i) const {
    const uint32_t cell = k < 4 ? k : k + 1;  // of a block of nine, without its middle
    const uint32_t nx = x + cell % 3 - 1;     // wraps around beyond the left and the upper edge
    const uint32_t ny = y + cell / 3 - 1;
    i = ny * width + nx;
    return nx < width && ny < height;
  }

  RELUME_HD static Rgb shown(const HashGridView& grid, const FilteredPixel& p) {
    return p.filtered ? p.seen + p.factor * grid.own_moments(p.slot).mean : p.seen;
  }
};

}  // namespace relume
