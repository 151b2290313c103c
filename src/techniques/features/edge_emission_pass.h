// Edges of lamps and sky as a pass; part of a frame if a denoiser is.
#pragma once

#include "pipeline/pass.h"
#include "techniques/features/settings.h"

namespace relume {

class EdgeEmissionPass final : public Pass {
 public:
  /// `max_bounces`, `mirrors`: as for FeaturesPass.
  EdgeEmissionPass(const FeatureSettings& settings, const int& max_bounces, bool mirrors)
      : settings_(settings), max_bounces_(max_bounces), mirrors_(mirrors) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  const FeatureSettings& settings_;
  const int& max_bounces_;
  bool mirrors_;
};

}  // namespace relume
