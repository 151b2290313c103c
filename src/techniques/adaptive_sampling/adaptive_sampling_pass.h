// The allocation "adaptive" as passes.
#pragma once

#include <vector>

#include "pipeline/pass.h"
#include "techniques/adaptive_sampling/pooled_deviation.h"
#include "techniques/adaptive_sampling/settings.h"

namespace relume {

/// Counts the samples that each pixel has taken from its sequence, which `FrameContext::index` reads: a pixel takes the
/// elements of its sequence one after the other, whichever frames they fall in.
class SampleCountPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};
/// The buffer that it owns and that the present stage adds to.
inline constexpr const char* kSampleCountBuffer = "sequence-samples";

class AdaptiveSamplingPass final : public Pass {
 public:
  /// `invalidated_by`: changes that the history does not survive.
  AdaptiveSamplingPass(const AdaptiveSamplingSettings& settings, Change invalidated_by)
      : settings_(settings), invalidated_by_(invalidated_by) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  /// The frame that ends the pilot clears the image, so it must not be abandoned.
  bool keeps_state() const override { return settings_.pilot; }
  size_t memory_bytes() const override {
    return rows_.capacity() * sizeof(PooledMoments) + totals_.capacity() * sizeof(double);
  }

 private:
  void allocate_as_paper(const FrameContext& frame) const;
  void allocate_by_deviation(const FrameContext& frame);
  /// The scale that gives `adaptive.rate` samples a pixel.
  SampleRate rate_for(const FrameContext& frame, View<const float> deviation);
  void forget_pilot(const FrameContext& frame) const;

  const AdaptiveSamplingSettings& settings_;
  Change invalidated_by_;
  std::vector<PooledMoments> rows_;
  std::vector<double> totals_;  ///< by row of pixels
};

}  // namespace relume
