// The allocation "adaptive" as a pass.
#pragma once

#include "pipeline/pass.h"
#include "techniques/adaptive_sampling/settings.h"

namespace relume {

class AdaptiveSamplingPass final : public Pass {
 public:
  /// `invalidated_by`: changes that the history does not survive.
  AdaptiveSamplingPass(const AdaptiveSamplingSettings& settings, Change invalidated_by)
      : settings_(settings), invalidated_by_(invalidated_by) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool adapts() const override { return true; }

 private:
  const AdaptiveSamplingSettings& settings_;
  Change invalidated_by_;
};

}  // namespace relume
