// Open Image Denoise as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/denoise/oidn/oidn_filter.h"

namespace relume {

class OidnPass final : public Pass {
 public:
  /// `caustic_layer`: filters the caustic layer separately from the rest of the image.
  explicit OidnPass(bool caustic_layer) : caustic_layer_(caustic_layer) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  /// Filters caustic layer and rest, and adds them. `features`: the other inputs and the output.
  void filter_parts(const FrameContext& frame, const View<const Rgb>& noisy, const OidnImages& features) const;

  bool caustic_layer_;
};

}  // namespace relume
