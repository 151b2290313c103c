// The firefly clamp as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/denoise/firefly_clamp/settings.h"

namespace relume {

/// Scales this frame's samples down before histories, denoisers and adaptive sampling use them.
class FireflyClampPass final : public Pass {
 public:
  explicit FireflyClampPass(const FireflySettings& settings) : settings_(settings) {}

  void configure(const FireflySettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  FireflySettings settings_;
};

}  // namespace relume
