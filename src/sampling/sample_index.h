// Sample indices of one frame: the sequence and the element of it that each pixel uses.
#pragma once

#include "core/view.h"
#include "sampling/sampler.h"

namespace relume {

struct SampleIndex {
  uint32_t seed = 0;
  uint32_t sequence = Sampler::kFirstSequence;  ///< number of the sequence; each has separate scrambles
  uint32_t sample = 0;                          ///< index within the sequence if `taken` is empty
  uint32_t frame = 0;                           ///< frames since the session began
  uint32_t age = 0;                             ///< frames since the seed last changed
  View<const uint32_t> taken = {};              ///< per pixel: number of elements that earlier frames used
  uint32_t width = 0;                           ///< of `taken`
  bool camera_runs = false;                     ///< one sequence for the camera through all epochs
  View<const uint16_t> tile = {};               ///< blue-noise tile; empty: each pixel has separate scrambles

  RELUME_HD_INLINE uint32_t sample_of(uint32_t x, uint32_t y) const {
    return taken.empty() ? sample : taken[y * width + x];
  }
  RELUME_HD_INLINE Sampler sampler(uint32_t x, uint32_t y) const {
    Sampler sampler = element(x, y, sample_of(x, y), sequence);
    // Learning structures do not steer the camera's dimensions, so their sequence continues through all epochs.
    if (runs_through()) sampler.take_camera_from(element(x, y, age, Sampler::kFirstSequence));
    return sampler;
  }
  /// Whether sampler(x, y) is element sample_of(x, y) of the pixel's own sequence, camera included.
  RELUME_HD bool is_plain() const { return tile.empty() && !runs_through(); }
  /// Whether the camera's dimensions have a separate sequence.
  RELUME_HD bool runs_through() const { return camera_runs && taken.empty(); }

 private:
  RELUME_HD_INLINE Sampler element(uint32_t x, uint32_t y, uint32_t i, uint32_t number) const {
    return tile.empty() ? Sampler::sequence(seed, x, y, i, number) : Sampler::dithered(tile, seed, x, y, i, number);
  }
};

/// Time of all paths of a frame within the shutter, in [0, 1), for estimators that join paths of several pixels. The
/// times of successive frames are evenly distributed.
inline float shared_shutter_time(const SampleIndex& index) {
  constexpr double kStep = 0.41421356237309515;  // √2 − 1
  constexpr uint32_t kSalt = 0x9b05688cu;
  const double u = static_cast<double>(to_unit_float(hash(index.seed, kSalt))) + kStep * index.age;
  return relume::min(static_cast<float>(u - std::floor(u)), kOneMinusEpsilon);
}

}  // namespace relume
