// Adaptive sampling as passes.
#pragma once

#include "frame/pass.h"
#include "frame/primitives/reduce.h"
#include "techniques/temporal/adaptive_sampling/pooled_deviation.h"
#include "techniques/temporal/adaptive_sampling/settings.h"

namespace relume {

/// Counts the elements that each pixel has taken from its sequence, which `FrameContext::index` reads. A pixel takes
/// them one after the other, whichever frames they fall in.
class SampleCountPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};
/// Probability of a sample, by pixel.
inline constexpr BufferKey<float> kSamplingProbability{"sampling-probability"};

class AdaptiveSamplingPass final : public Pass {
 public:
  /// `invalidated_by`: changes that end the history.
  AdaptiveSamplingPass(const AdaptiveSamplingSettings& settings, Change invalidated_by, Memory& memory)
      : settings_(settings), invalidated_by_(invalidated_by), moments_(memory), rows_(memory) {}

  void configure(const AdaptiveSamplingSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return moments_.memory_bytes() + rows_.memory_bytes() + scratch_.memory_bytes();
  }

 private:
  void allocate_as_paper(const FrameContext& frame) const;
  void allocate_by_deviation(const FrameContext& frame);
  /// Whether probabilities follow the samples in this frame. True in the first frames after a change, then about once
  /// per sample of each pixel: fewer new samples carry little information.
  bool estimates_in(const FrameContext& frame) const;
  void estimate_deviation(const FrameContext& frame);
  SampleRate rate_for(const FrameContext& frame, View<const float> deviation);
  /// The scale s at which the limit of one sample per frame removes 5 % of the samples. There the mean of min(s σ, 1)
  /// is 0.95 s times `average`, the mean of σ.
  SampleRate rate_that_cuts_little(const FrameContext& frame, View<const float> deviation, double average);
  /// The scale that gives `adaptive.rate` samples per pixel.
  SampleRate rate_of_average(const FrameContext& frame, View<const float> deviation, double average);
  /// Means over the pixels.
  RateSums means_of(const FrameContext& frame, View<const float> deviation, const SampleRate& rate);

  AdaptiveSamplingSettings settings_;
  Change invalidated_by_;
  Array<PooledMoments> moments_;  ///< statistics of single pixels
  Array<PooledMoments> rows_;     ///< sums over the neighbours in the row of each pixel
  PrimitiveScratch scratch_;
};

}  // namespace relume
