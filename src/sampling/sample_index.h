// The samples of one frame: which element of which sequence each pixel takes.
#pragma once

#include "core/view.h"
#include "sampling/sampler.h"

namespace relume {

struct SampleIndex {
  uint32_t seed = 0;
  uint32_t sequence = Sampler::kFirstSequence;  ///< number of the sequence; a new one has scrambles of its own
  uint32_t sample = 0;                          ///< index within the sequence, where `taken` is empty
  uint32_t frame = 0;                           ///< frames since the session began
  uint32_t age = 0;                             ///< frames since the seed last changed
  View<const uint32_t> taken = {};              ///< by pixel: elements that earlier frames took from the sequence
  uint32_t width = 0;                           ///< of `taken`
  bool camera_runs = false;                     ///< the camera's dimensions have one sequence through all epochs
  View<const uint16_t> tile = {};               ///< of blue noise; empty: each pixel has scrambles of its own

  RELUME_HD_INLINE uint32_t sample_of(uint32_t x, uint32_t y) const {
    return taken.empty() ? sample : taken[y * width + x];
  }
  RELUME_HD_INLINE Sampler sampler(uint32_t x, uint32_t y) const {
    Sampler sampler = element(x, y, sample_of(x, y), sequence);
    // Structures that learn decide nothing about the camera, so its sequence runs through all of their epochs.
    if (runs_through()) sampler.take_camera_from(element(x, y, age, Sampler::kFirstSequence));
    return sampler;
  }
  /// Whether sampler(x, y) is element sample_of(x, y) of the pixel's own sequence, camera included.
  RELUME_HD bool is_plain() const { return tile.empty() && !runs_through(); }
  /// Whether the camera's dimensions have a sequence of their own.
  RELUME_HD bool runs_through() const { return camera_runs && taken.empty(); }

 private:
  RELUME_HD_INLINE Sampler element(uint32_t x, uint32_t y, uint32_t i, uint32_t number) const {
    return tile.empty() ? Sampler::sequence(seed, x, y, i, number) : Sampler::dithered(tile, seed, x, y, i, number);
  }
};

}  // namespace relume
