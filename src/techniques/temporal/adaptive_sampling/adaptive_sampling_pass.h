// The allocation "adaptive" as passes.
#pragma once

#include <vector>

#include "frame/pass.h"
#include "techniques/temporal/adaptive_sampling/pooled_deviation.h"
#include "techniques/temporal/adaptive_sampling/settings.h"

namespace relume {

/// Counts the samples that each pixel has taken from its sequence, which `FrameContext::index` reads: a pixel takes the
/// elements of its sequence one after the other, whichever frames they fall in.
class SampleCountPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};
/// Probability with which a pixel gets a sample.
inline constexpr BufferKey<float> kSamplingProbability{"sampling-probability"};

class AdaptiveSamplingPass final : public Pass {
 public:
  /// `invalidated_by`: changes that the history does not survive.
  AdaptiveSamplingPass(const AdaptiveSamplingSettings& settings, Change invalidated_by)
      : settings_(settings), invalidated_by_(invalidated_by) {}

  void configure(const AdaptiveSamplingSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return (moments_.capacity() + rows_.capacity()) * sizeof(PooledMoments) + totals_.capacity() * sizeof(double);
  }

 private:
  void allocate_as_paper(const FrameContext& frame) const;
  void allocate_by_deviation(const FrameContext& frame);
  /// Whether probabilities follow the samples in this frame: about once a sample of each pixel, as fewer new samples
  /// tell little; in every frame while something changes.
  bool estimates_in(const FrameContext& frame) const;
  void estimate_deviation(const FrameContext& frame);
  SampleRate rate_for(const FrameContext& frame, View<const float> deviation);
  /// The scale s at which the bound of one sample a frame cuts 5 % off what proportion asks for: the mean of
  /// min(s σ, 1) is 0.95 s times the mean of σ, `average`.
  SampleRate rate_that_cuts_little(const FrameContext& frame, View<const float> deviation, double average);
  /// The scale that gives `adaptive.rate` samples a pixel.
  SampleRate rate_of_average(const FrameContext& frame, View<const float> deviation, double average);
  /// Mean over the pixels of value(values[pixel]).
  template <typename Value>
  double mean_of(const FrameContext& frame, View<const float> values, const Value& value);

  AdaptiveSamplingSettings settings_;
  Change invalidated_by_;
  std::vector<PooledMoments> moments_;  ///< by pixel
  std::vector<PooledMoments> rows_;     ///< sums over the pixels of a row around each pixel
  std::vector<double> totals_;          ///< by row of pixels
};

}  // namespace relume
