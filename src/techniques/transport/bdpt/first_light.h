// Record of the light at the first vertex of bidirectional paths. Histories use it to verify a pixel for another
// viewpoint. Many strategies, and light subpaths of other pixels, contribute to a pixel. One of their directions is
// chosen at random, in proportion to the contribution. Where camera subpaths fill cells, one direction of splats is
// chosen beside one of the subpaths: cells lack the light of splats.
#pragma once

#include "core/fixed_point.h"
#include "core/hash.h"
#include "core/octahedral.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {

/// Key of a contribution in a weighted choice: the largest key wins, with a probability proportional to `weight`
/// ([Efraimidis06]). The choice does not depend on the order of the contributions. `bits`: uniform and independent.
RELUME_HD inline float choice_key(float weight, uint32_t bits) {
  const float u = (static_cast<float>(static_cast<int32_t>(bits >> 9)) + 0.5f) * 0x1p-23f;  // in (0, 1)
  return weight / -math::log(u);
}

struct FirstLight {
  View<FirstVertex> vertices;  ///< by pixel; empty: nothing is recorded
  View<uint64_t> chosen;       ///< by pixel: key and octahedral direction of the largest key so far; 0: none
  uint32_t seed = 0;           ///< of the frame
  float splat_scale = 1;       ///< pixels over light subpaths of the frame
  View<uint64_t> splats = {};  ///< as `chosen`, for splats alone; empty: `chosen` has them, too

  RELUME_HD bool empty() const { return vertices.empty(); }

  /// Clears the record of a pixel. Its direction may already be that of a splat.
  RELUME_HD void begin(uint32_t pixel) const {
    if (!empty()) vertices[pixel] = {};
  }

  /// Offers a contribution to the pixel, in radiance. `direction`: from the first vertex to the light. `id`: unique in
  /// the frame.
  RELUME_HD void offer(uint32_t pixel, const Vec3& direction, const Rgb& value, uint32_t id) const {
    if (!empty()) offer_packed(chosen, pixel, pack_direction(direction), value, id);
  }
  /// The same for a contribution of a light subpath, before it is scaled. `direction`: octahedral.
  RELUME_HD void offer_splat(uint32_t pixel, uint32_t direction, const Rgb& value, uint32_t id) const {
    if (!empty()) offer_packed(splats.empty() ? chosen : splats, pixel, direction, value * splat_scale, id);
  }

 private:
  RELUME_HD void offer_packed(const View<uint64_t>& largest, uint32_t pixel, uint32_t direction, const Rgb& value,
                              uint32_t id) const {
    const float weight = luminance(value);
    if (!(weight > 0.0f)) return;  // black, or not a number
    const float key = choice_key(weight, hash(seed, pixel, id));
    atomic_max(&largest[pixel], (static_cast<uint64_t>(float_bits(key)) << 32) | direction);
  }
};

}  // namespace relume
