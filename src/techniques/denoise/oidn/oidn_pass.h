// Open Image Denoise as a pass.
#pragma once

#include "frame/pass.h"

namespace relume {

class OidnPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

}  // namespace relume
