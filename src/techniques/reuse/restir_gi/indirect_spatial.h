// Second kernel of ReSTIR GI: combines each pixel's reservoir with those of neighbouring pixels, and adds the light of
// the result ([Ouyang21], with the pairwise weights of [Lin22]).
#pragma once

#include "techniques/reuse/reservoir/combine_neighbours.h"
#include "techniques/reuse/restir_gi/indirect_image.h"

namespace relume {

struct IndirectSpatialKernel {
  SceneView scene;
  ReconnectionRule rule;
  NeighbourSearch search;
  View<const IndirectReservoir> reservoirs;  ///< before this kernel
  View<const ReceiverRecord> records;
  View<IndirectReservoir> history;  ///< for the next frame
  IndirectImage image;
  uint32_t seed = 0;
  uint32_t frame = 0;
  bool traced = true;      ///< whether targets contain occlusion
  bool feeds_back = true;  ///< whether the history is the result of this kernel

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * search.width + x;
    const IndirectReservoir own = reservoirs[pixel];
    if (!(own.confidence > 0.0f) || !image.planes.sampled.has(pixel)) {
      history[pixel] = own;
      return;
    }
    Receiver r;
    make_receiver(scene, records[pixel], r);
    ChoiceNumbers numbers(seed, frame, pixel, kChoosesIndirectNeighbours);
    ReuseNeighbours near;
    const auto has_reservoir = [&](uint32_t other) { return reservoirs[other].confidence > 0.0f; };
    search.find(x, y, has_reservoir, numbers, near);
    IndirectReservoir result = combine(pixel, own, r, near, numbers);
    shade(pixel, r, result, numbers.next());
    if (!is_finite(result.weight)) result.weight = 0;  // must not spread
    history[pixel] = feeds_back ? result : own;
  }

 private:
  /// Whether a vertex moves between two pixels.
  RELUME_HD bool connects(const IndirectVertex& vertex, const SurfacePlace& place, uint32_t a, uint32_t b) const {
    return rule.moves(vertex) && rule.connects(reconnect(position_of(records[a]), place).geometry(),
                                               reconnect(position_of(records[b]), place).geometry());
  }

  /// p̂ at `pixel`, with receiver `r`, of the sample of pixel `from`.
  RELUME_HD float target_here(uint32_t pixel, const Receiver& r, uint32_t from, const IndirectVertex& vertex) const {
    const SurfacePlace place = place_of(scene, vertex);
    if (!connects(vertex, place, pixel, from)) return 0.0f;
    return moved_target(scene, r, vertex, place, traced, image.planes.rays[pixel]);
  }

  /// p̂ at pixel `other` of a sample of `pixel`.
  RELUME_HD float target_there(uint32_t pixel, uint32_t other, const IndirectVertex& vertex) const {
    const SurfacePlace place = place_of(scene, vertex);
    if (!connects(vertex, place, pixel, other)) return 0.0f;
    Receiver r;
    make_receiver(scene, records[other], r);
    return moved_target(scene, r, vertex, place, traced, image.planes.rays[pixel]);
  }

  RELUME_HD IndirectReservoir combine(uint32_t pixel, const IndirectReservoir& own, const Receiver& r,
                                      const ReuseNeighbours& near, ChoiceNumbers& numbers) const {
    const auto here = [&](uint32_t i, const IndirectVertex& vertex) {
      return target_here(pixel, r, near.pixels[i], vertex);
    };
    const auto there = [&](uint32_t i, const IndirectVertex& vertex) {
      return target_there(pixel, near.pixels[i], vertex);
    };
    if (!traced) return combine_neighbours_basic(own, reservoirs, near, here, there, numbers);
    return combine_neighbours_pairwise(
        own, reservoirs, near,
        [&](uint32_t i, const IndirectReservoir& neighbour) { return here(i, neighbour.sample); },
        [&](uint32_t i) { return there(i, own.sample); }, numbers);
  }

  /// Adds the light of the result. Without occlusion in the targets, a ray decides whether it arrives. `u`: as for
  /// IndirectImage::add().
  RELUME_HD void shade(uint32_t pixel, const Receiver& r, const IndirectReservoir& result, float u) const {
    if (!image.planes.takes(result.weight, pixel)) return;
    const SurfacePlace place = place_of(scene, result.sample);
    const Reconnection c = reconnect(r.sp.position, place);
    if (!traced) {
      ++image.planes.rays[pixel];
      if (!sees(scene, r, c, place.error)) return;
    }
    image.add(scene, r, c, result.sample.radiance, result.weight, pixel, u);
  }
};

}  // namespace relume
