// Edges of lamps and sky as a pass, which runs if the frame has a denoiser.
#pragma once

#include "frame/pass.h"
#include "techniques/gbuffer/features/settings.h"
#include "techniques/transport/path/settings.h"

namespace relume {

class EdgeEmissionPass final : public Pass {
 public:
  /// `path`, `mirrors`: as for FeaturesPass.
  EdgeEmissionPass(const FeatureSettings& settings, const PathSettings& path, bool mirrors)
      : settings_(settings), max_bounces_(path.max_bounces), mirrors_(mirrors) {}
  void configure(const PathSettings& path) { max_bounces_ = path.max_bounces; }

  void configure(const FeatureSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  FeatureSettings settings_;
  int max_bounces_;
  bool mirrors_;
};

}  // namespace relume
