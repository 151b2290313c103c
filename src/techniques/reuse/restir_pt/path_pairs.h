// Reciprocal neighbours of ReSTIR PT ([Lin26]): where pixel a reuses the reservoir of b, b reuses that of a. The shift
// of a path from a to b then also is the inverse shift that b's combination needs.
#pragma once

#include "techniques/reuse/reservoir/neighbours.h"
#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/reuse/restir_pt/path_shift.h"

namespace relume {

/// Edge of the tiles that contain both pixels of a pair: the greatest power of two up to twice the radius in pixels.
RELUME_HD inline uint32_t pair_tile_edge(float radius) {
  uint32_t edge = 1;
  while (static_cast<float>(static_cast<int>(2 * edge)) <= 2.0f * radius) edge *= 2;
  return edge;
}

/// Pairs the pixels of square tiles, whose origin changes from frame to frame. Within a tile, pair number i of all
/// pixels flips the same bits of their coordinates, which makes it an involution.
struct PairSearch {
  NeighbourSearch search;  ///< tests surfaces; its own pattern is not used
  uint32_t seed = 0;
  uint32_t frame = 0;
  uint32_t edge = 2;  ///< of tiles, a power of two of at least 2

  /// The other pixel of pair `i`; kNoSurface: it lies outside the image.
  RELUME_HD uint32_t partner(uint32_t x, uint32_t y, uint32_t i) const {
    const uint32_t in_tile = edge - 1;
    const uint32_t origin = hash(seed, frame, kChoosesPathPairs);
    const uint32_t shift_x = origin & in_tile;
    const uint32_t shift_y = (origin >> 16u) & in_tile;
    const uint32_t tile = hash((x + shift_x) / edge, (y + shift_y) / edge);
    const uint32_t flips = 1 + hash(origin, tile, i) % (edge * edge - 1);  // at least one bit
    const uint32_t other_x = ((x + shift_x) ^ (flips & in_tile)) - shift_x;
    const uint32_t other_y = ((y + shift_y) ^ (flips / edge)) - shift_y;
    // Coordinates below zero wrap to large ones.
    if (other_x >= search.width || other_y >= search.height) return kNoSurface;
    return other_y * search.width + other_x;
  }

  /// The other pixel of pair `i` if each is a neighbour of the other by its surface, else kNoSurface.
  /// `has_reservoir(pixel)`: whether its surface can have a sample.
  template <typename HasReservoir>
  RELUME_HD uint32_t find(uint32_t x, uint32_t y, uint32_t i, const HasReservoir& has_reservoir) const {
    const uint32_t pixel = y * search.width + x;
    const uint32_t other = partner(x, y, i);
    if (other == kNoSurface || !has_reservoir(other)) return kNoSurface;
    // The tolerance of depth is relative to one of both pixels.
    return search.similar(pixel, other) && search.similar(other, pixel) ? other : kNoSurface;
  }
};

/// A neighbour's path at this pixel.
struct PairedPath {
  Rgb value{0};      ///< as StoredPath::value; black unless the shift is defined
  Vec3 first{0};     ///< as StoredPath::first
  float target = 0;  ///< p̂ of the path here
};

/// Shifts the paths of each pixel's neighbours to this pixel. Pairs in which no pixel has a path need no shift.
struct PathPairKernel {
  PathShifter shifter;
  PairSearch pairs;
  View<const PathReservoir> reservoirs;
  View<const ReceiverRecord> records;
  View<PairedPath> paths[kMostReuseNeighbours];  ///< by number of the pair
  View<uint32_t> rays;
  SampledPixels sampled;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * shifter.width + x;
    const auto has_reservoir = [&](uint32_t other) { return reservoirs[other].confidence > 0.0f; };
    for (uint32_t i = 0; i < pairs.search.count; ++i) {
      PairedPath& path = paths[i][pixel];
      path = {};
      if (!has_reservoir(pixel)) continue;
      const uint32_t other = pairs.find(x, y, i, has_reservoir);
      if (other == kNoSurface || !(reservoirs[other].weight > 0.0f)) continue;
      if (!sampled.has(pixel) && !sampled.has(other)) continue;
      const SceneView& scene = shifter.context.scene;
      const ReceiverRecord& record = records[pixel];
      const Instance& instance = scene.instances[record.hit.instance];
      const Shifted shifted =
          shifter.shift(reservoirs[other].sample, scene.camera, instance, record, true, rays[pixel]);
      path = {shifted.value, shifted.first, shifted.target};
    }
  }
};

}  // namespace relume
