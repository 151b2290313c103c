// The filter of the caustic layer as a pass, for denoisers that accumulate light at surfaces.
#pragma once

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/denoise/shared/find_light_change.h"
#include "techniques/denoise/svgf/settings.h"

namespace relume {

/// Accumulates and filters the caustic layer. The denoiser adds the result to its image (SurfaceLight::caustics).
class CausticLayerPass final : public Pass {
 public:
  explicit CausticLayerPass(Memory& memory) : change_(memory), features_(memory), light_(memory), filtered_(memory) {}

  void configure(const SvgfSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return features_.memory_bytes() + light_.memory_bytes() + filtered_.memory_bytes() + change_.memory_bytes();
  }

 private:
  // These return false if a stop was requested first.
  bool accumulate(const FrameContext& frame);
  bool prepare(const FrameContext& frame);
  bool present(const FrameContext& frame);

  SvgfSettings settings_;
  LightChange change_;
  Array<float> features_;
  Array<float> light_;
  Array<float> filtered_;
};

}  // namespace relume
