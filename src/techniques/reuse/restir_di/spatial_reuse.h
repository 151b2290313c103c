// Second kernel of ReSTIR DI: combines each pixel's reservoir with those of neighbouring pixels, and adds the light of
// the result ([Bitterli20] alg. 5, with the pairwise weights of [Lin22]).
#pragma once

#include "techniques/reuse/reservoir/combine_neighbours.h"
#include "techniques/reuse/reservoir/ris.h"
#include "techniques/reuse/restir_di/settings.h"

namespace relume {

struct SpatialReuseKernel {
  SceneView scene;
  View<const LightReservoir> reservoirs;  ///< before this kernel
  View<const ReceiverRecord> records;
  NeighbourSearch search;
  View<LightReservoir> history;  ///< for the next frame
  ReservoirImage image;
  uint32_t seed = 0;
  uint32_t frame = 0;
  bool traced = true;      ///< whether targets contain occlusion
  bool feeds_back = true;  ///< whether the history is the result of this kernel

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * search.width + x;
    const LightReservoir own = reservoirs[pixel];
    if (!(own.confidence > 0.0f) || !image.planes.sampled.has(pixel)) {
      history[pixel] = own;
      return;
    }
    Receiver r;
    make_receiver(scene, records[pixel], r);
    ChoiceNumbers numbers(seed, frame, pixel, kChoosesNeighbours);
    ReuseNeighbours near;
    const auto has_reservoir = [&](uint32_t other) { return reservoirs[other].confidence > 0.0f; };
    search.find(x, y, has_reservoir, numbers, near);
    LightReservoir result = combine(pixel, own, r, near, numbers);
    shade(pixel, r, result);
    if (!is_finite(result.weight)) result.weight = 0;  // must not spread
    history[pixel] = feeds_back ? result : own;
  }

 private:
  /// p̂ of a sample at a pixel.
  RELUME_HD float target_of(uint32_t pixel, const LightPoint& point, uint32_t& rays) const {
    Receiver other;
    make_receiver(scene, records[pixel], other);
    return target_at(scene, scene.lights, other, point, traced, rays);
  }

  RELUME_HD LightReservoir combine(uint32_t pixel, const LightReservoir& own, const Receiver& r,
                                   const ReuseNeighbours& near, ChoiceNumbers& numbers) const {
    uint32_t& rays = image.planes.rays[pixel];
    const auto here = [&](const LightPoint& point) { return target_at(scene, scene.lights, r, point, traced, rays); };
    const auto there = [&](uint32_t i, const LightPoint& point) { return target_of(near.pixels[i], point, rays); };
    if (!traced) {
      const auto basic = [&](uint32_t, const LightPoint& point) { return here(point); };
      return combine_neighbours_basic(own, reservoirs, near, basic, there, numbers);
    }
    return combine_neighbours_pairwise(
        own, reservoirs, near, [&](uint32_t, const LightReservoir& neighbour) { return here(neighbour.sample); },
        [&](uint32_t i) { return there(i, own.sample); }, numbers);
  }

  /// Adds the light of the result. Without occlusion in the targets, a ray decides whether it arrives.
  RELUME_HD void shade(uint32_t pixel, const Receiver& r, const LightReservoir& result) const {
    if (!traced && result.weight > 0.0f) {
      ++image.planes.rays[pixel];
      if (!sees(scene, r, light_at(scene.lights, result.sample, r.sp.position))) return;
    }
    image.add(scene, r, result, pixel);
  }
};

}  // namespace relume
