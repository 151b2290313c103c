// The random numbers of one sample of one pixel: a pure function of (seed, pixel, sample, dimension).
#pragma once

#include "sampling/choose.h"
#include "sampling/sobol.h"

namespace relume {

/// Hands out dimensions in order. Each request is a padded, independently scrambled low-discrepancy sequence over the
/// samples of the pixel ([Burley20], §5).
class Sampler {
 public:
  /// Stands for the frame where one sequence runs through all of them.
  static constexpr uint32_t kAllFrames = 0xffffffffu;

  /// To be assigned before use.
  Sampler() = default;
  /// Continues one sequence over all samples of the pixel: for estimators that do not adapt.
  RELUME_HD_INLINE static Sampler sequence(uint32_t seed, uint32_t x, uint32_t y, uint32_t sample) {
    return independent(seed, x, y, kAllFrames, sample);
  }
  /// Draws each frame with a scramble of its own: for whatever adapts to what earlier frames found.
  RELUME_HD_INLINE static Sampler independent(uint32_t seed, uint32_t x, uint32_t y, uint32_t frame, uint32_t sample) {
    return Sampler(hash(hash(seed, x, y), frame), sample);
  }

  /// Two stratified numbers. Eight dimensions are computed at a time: on a processor they share vector registers, and a
  /// path rarely needs more.
  RELUME_HD Vec2 next_2d() {
    const uint32_t in_block = dimension_ % kBlock;
    if (dimension_ - in_block != block_start_) fill_block(dimension_ - in_block);
    ++dimension_;
    return {x_[in_block], y_[in_block]};
  }

  /// The first pair, without the rest of its block: for passes that need no more.
  RELUME_HD_INLINE Vec2 first_2d() const { return owen_sobol_2d(reversed_index_, seed_of(0)); }

  /// One stratified number; these have dimensions of their own.
  RELUME_HD_INLINE float next_1d() {
    return owen_van_der_corput(reversed_index_, hash(scramble_ ^ kSalt1d, single_++));
  }

  /// Jumps to a dimension, so that paths agree on which number decides what however long they are.
  RELUME_HD void start_dimension(uint32_t dimension) {
    dimension_ = dimension;
    single_ = dimension * 8;
  }

  /// A hash that differs between the rays of this sample; decides stochastic alpha.
  RELUME_HD uint32_t ray_id() const { return hash((scramble_ ^ reversed_index_) + dimension_ * 0x9e3779b9u); }
  /// The numbers of the dimension handed out last, with more bits below them.
  RELUME_HD_INLINE ReusableNumber reusable(float u) const {
    return {u, (scramble_ ^ reversed_index_) + dimension_ * 0x9e3779b9u + kSaltBits};
  }

  RELUME_HD uint32_t camera_ray_id() const { return hash(scramble_ ^ reversed_index_); }

 private:
  static constexpr uint32_t kBlock = 8;
  static constexpr uint32_t kSalt1d = 0x68bc21ebu;
  static constexpr uint32_t kSaltBits = 0x2c1b3c6du;

  RELUME_HD_INLINE Sampler(uint32_t scramble, uint32_t index)
      : scramble_(scramble), reversed_index_(reverse_bits(index)) {}

  RELUME_HD uint32_t seed_of(uint32_t dimension) const { return hash(scramble_ + dimension); }

  RELUME_HD void fill_block(uint32_t start) {
    block_start_ = start;
    for (uint32_t k = 0; k < kBlock; ++k) {
      const Vec2 point = owen_sobol_2d(reversed_index_, seed_of(start + k));
      x_[k] = point.x;
      y_[k] = point.y;
    }
  }

  uint32_t scramble_;
  uint32_t reversed_index_;
  uint32_t dimension_ = 0;
  uint32_t single_ = 0;
  uint32_t block_start_ = 0xffffffffu;
  float x_[kBlock];
  float y_[kBlock];
};

}  // namespace relume
