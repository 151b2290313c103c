// The split of light as a pass, which runs if a denoiser keeps diffuse and specular light apart.
#pragma once

#include "frame/pass.h"

namespace relume {

class SplitLightPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

}  // namespace relume
