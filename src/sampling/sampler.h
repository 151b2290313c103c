// The random numbers of one sample of one pixel: a pure function of (seed, pixel, sample, dimension).
#pragma once

#include "sampling/sobol.h"

namespace relume {

/// Hands out dimensions in order. Each request of one or two numbers is a padded, independently scrambled
/// low-discrepancy sequence over the samples of the pixel ([Burley20], §5).
class Sampler {
 public:
  /// Continues one sequence over all samples of the pixel: for estimators that do not adapt.
  RELUME_HD static Sampler sequence(uint32_t seed, uint32_t x, uint32_t y, uint32_t sample) {
    return Sampler(hash(seed, x, y), sample);
  }
  /// Draws each frame with a scramble of its own: for whatever adapts to what earlier frames found.
  RELUME_HD static Sampler independent(uint32_t seed, uint32_t x, uint32_t y, uint32_t frame, uint32_t sample) {
    return Sampler(hash(hash(seed, x, y), frame), sample);
  }

  RELUME_HD float next_1d() { return owen_van_der_corput(reversed_index_, hash(scramble_ + dimension_++)); }
  RELUME_HD Vec2 next_2d() { return owen_sobol_2d(reversed_index_, hash(scramble_ + dimension_++)); }

  /// Jumps to a dimension, so that paths agree on which number decides what however long they are.
  RELUME_HD void start_dimension(uint32_t dimension) { dimension_ = dimension; }

  /// A hash that differs between the rays of this sample; decides stochastic alpha.
  RELUME_HD uint32_t ray_id() const { return hash(scramble_ ^ reversed_index_, dimension_); }

 private:
  RELUME_HD Sampler(uint32_t scramble, uint32_t index) : scramble_(scramble), reversed_index_(reverse_bits(index)) {}

  uint32_t scramble_;
  uint32_t reversed_index_;
  uint32_t dimension_ = 0;
};

}  // namespace relume
