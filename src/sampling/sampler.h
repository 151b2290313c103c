// Random numbers of one sample of one pixel: a pure function of (seed, pixel, sample, dimension).
#pragma once

#include "core/lanes.h"
#include "sampling/blue_noise.h"
#include "sampling/choose.h"
#include "sampling/sobol.h"

namespace relume {

/// Number of dimension pairs for the camera, which come first: a point of the pixel and one of the lens.
inline constexpr uint32_t kCameraDimensions = 2;

/// Provides dimensions in order. Each pair of next_2d() and each number of next_1d() has a padded, independently
/// scrambled low-discrepancy sequence over the samples of the pixel ([Burley20], §5).
class Sampler {
 public:
  /// Number of a pixel's first sequence.
  static constexpr uint32_t kFirstSequence = 0xffffffffu;

  /// Must be assigned before use.
  Sampler() = default;
  /// Element `sample` of a sequence of the pixel. Sequences with different numbers have independent scrambles.
  RELUME_HD_INLINE static Sampler sequence(uint32_t seed, uint32_t x, uint32_t y, uint32_t sample,
                                           uint32_t number = kFirstSequence) {
    const uint32_t scramble = hash(hash(seed, x, y), number);
    return Sampler(scramble, scramble, sample);
  }
  /// The same with one scramble for all pixels; a blue-noise tile shifts the numbers per pixel instead ([Georgiev16]).
  RELUME_HD_INLINE static Sampler dithered(const View<const uint16_t>& tile, uint32_t seed, uint32_t x, uint32_t y,
                                           uint32_t sample, uint32_t number = kFirstSequence) {
    constexpr uint32_t kSaltDither = 0xb5297a4du;
    Sampler sampler(hash(hash(seed, kSaltDither), number), hash(hash(seed, x, y), number), sample);
    sampler.shifts_ = {tile, x, y};
    return sampler;
  }
  /// Takes the camera's dimensions from another sequence of the pixel. Epochs start new sequences for the dimensions
  /// that learning techniques steer; the camera's sequence continues through all epochs.
  RELUME_HD_INLINE void take_camera_from(const Sampler& other) {
    camera_scramble_ = other.scramble_;
    camera_index_ = other.reversed_index_;
  }

  /// Two stratified numbers. The host computes blocks of eight dimensions, which share vector registers; a path rarely
  /// needs more.
  RELUME_HD Vec2 next_2d() {
    const uint32_t in_block = dimension_ % kBlock;
    if (dimension_ - in_block != block_start_) fill_block(dimension_ - in_block);
    ++dimension_;
    return {x_[in_block], y_[in_block]};
  }

  /// The first pair without the rest of its block, for passes that need only the pair.
  RELUME_HD_INLINE Vec2 first_2d() const { return camera_2d(0); }

  /// One stratified number, from dimensions separate from those of next_2d().
  RELUME_HD_INLINE float next_1d() { return single(single_++); }

  /// The first number of next_1d() after start_dimension(dimension). Does not advance the sampler.
  RELUME_HD float number_of(uint32_t dimension) const { return single(dimension * kSinglesPerDimension); }

  /// Time of the sample within the shutter, in [0, 1). It continues with the camera's sequence, in a dimension of its
  /// own.
  RELUME_HD_INLINE float shutter_number() const {
    const uint32_t seed = hash(camera_scramble_ ^ kSaltShutter);
    const float u = owen_van_der_corput(camera_index_, seed);
    return shifts_.tile.empty() ? u : wrap(u + shifts_.shift(seed));
  }

  /// Jumps to a dimension, so that a decision uses the same dimension in paths of any length.
  RELUME_HD void start_dimension(uint32_t dimension) {
    dimension_ = dimension;
    single_ = dimension * kSinglesPerDimension;
  }

  /// A hash that differs between the rays of this sample, for stochastic alpha.
  RELUME_HD uint32_t ray_id() const { return hash((identity_ ^ reversed_index_) + dimension_ * 0x9e3779b9u); }
  /// A number `u` of the last dimension, extended by hash bits.
  RELUME_HD_INLINE ReusableNumber reusable(float u) const {
    return {u, (identity_ ^ reversed_index_) + dimension_ * 0x9e3779b9u + kSaltBits};
  }

  /// ray_id() of the camera ray, from any dimension.
  RELUME_HD uint32_t camera_ray_id() const { return hash(identity_ ^ reversed_index_); }

 private:
  static constexpr uint32_t kBlock = kWidthOf<HostLanes>;
  static constexpr uint32_t kSinglesPerDimension = 8;
  static constexpr uint32_t kSalt1d = 0x68bc21ebu;
  static constexpr uint32_t kSaltBits = 0x2c1b3c6du;
  static constexpr uint32_t kSaltShutter = 0x3f84d5b5u;
  static constexpr uint32_t kSaltX = 0x1b56c4e9u;
  static constexpr uint32_t kSaltY = 0x7feb352du;

  RELUME_HD_INLINE Sampler(uint32_t scramble, uint32_t identity, uint32_t index)
      : scramble_(scramble),
        reversed_index_(reverse_bits(index)),
        identity_(identity),
        camera_scramble_(scramble),
        camera_index_(reversed_index_) {}

  RELUME_HD_INLINE float single(uint32_t number) const {
    const uint32_t seed = hash(scramble_ ^ kSalt1d, number);
    const float u = owen_van_der_corput(reversed_index_, seed);
    return shifts_.tile.empty() ? u : wrap(u + shifts_.shift(seed));
  }
  RELUME_HD uint32_t seed_of(uint32_t dimension) const { return hash(scramble_ + dimension); }
  RELUME_HD_INLINE Vec2 camera_2d(uint32_t dimension) const {
    const uint32_t seed = hash(camera_scramble_ + dimension);
    return shifted(owen_sobol_2d(camera_index_, seed), seed);
  }
  RELUME_HD_INLINE static float wrap(float u) { return u < 1.0f ? u : relume::min(u - 1.0f, kOneMinusEpsilon); }
  RELUME_HD_INLINE Vec2 shifted(const Vec2& u, uint32_t seed) const {
    if (shifts_.tile.empty()) return u;
    return {wrap(u.x + shifts_.shift(seed ^ kSaltX)), wrap(u.y + shifts_.shift(seed ^ kSaltY))};
  }

  RELUME_HD void fill_block(uint32_t start) {
    block_start_ = start;
    for (uint32_t k = 0; k < kBlock; ++k) {
      const Vec2 point = owen_sobol_2d(reversed_index_, seed_of(start + k));
      x_[k] = point.x;
      y_[k] = point.y;
    }
    if (!shifts_.tile.empty()) {
      for (uint32_t k = 0; k < kBlock; ++k) set(k, shifted({x_[k], y_[k]}, seed_of(start + k)));
    }
    const bool own_camera = camera_scramble_ != scramble_ || camera_index_ != reversed_index_;
    for (uint32_t k = 0; k < kBlock && start + k < kCameraDimensions && own_camera; ++k) set(k, camera_2d(start + k));
  }
  RELUME_HD_INLINE void set(uint32_t k, const Vec2& point) {
    x_[k] = point.x;
    y_[k] = point.y;
  }

  uint32_t scramble_;
  uint32_t reversed_index_;
  uint32_t identity_;  ///< identity of the pixel's sample stream, even where `scramble_` is shared
  uint32_t camera_scramble_;
  uint32_t camera_index_;  ///< with its bits reversed
  BlueNoisePixel shifts_;  ///< without a tile: none
  uint32_t dimension_ = 0;
  uint32_t single_ = 0;
  uint32_t block_start_ = 0xffffffffu;
  float x_[kBlock];
  float y_[kBlock];
};

}  // namespace relume
