// The specular part of reprojection as a pass. See specular_history.h.
#pragma once

#include "frame/pass.h"
#include "techniques/temporal/reprojection/settings.h"

namespace relume {

/// Runs before ReprojectionPass.
class SpecularHistoryPass final : public Pass {
 public:
  explicit SpecularHistoryPass(const ReprojectionSettings& settings) : settings_(settings) {}

  void configure(const ReprojectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  ReprojectionSettings settings_;
};

}  // namespace relume
