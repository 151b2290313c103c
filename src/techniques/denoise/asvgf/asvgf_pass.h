// A-SVGF as a pass.
#pragma once

#include "techniques/denoise/asvgf/gradient_pass.h"
#include "techniques/denoise/asvgf/settings.h"
#include "techniques/denoise/svgf/svgf_pass.h"

namespace relume {

/// λ of each pixel (adaptive_alpha.h). Exists only with gradients.
inline constexpr BufferKey<float> kAsvgfLambda{"asvgf-lambda"};

/// SVGF that shortens histories by gradients of light.
class AsvgfPass final : public SvgfPass {
 public:
  /// `gradients`: nullptr if the estimator has none; changes are then found by blocks, as in SVGF. `split`: as for
  /// SvgfPass.
  AsvgfPass(const AsvgfSettings& settings, bool split, const GradientPass* gradients, Memory& memory)
      : SvgfPass(svgf_settings(settings, gradients != nullptr), split, memory),
        settings_(settings),
        gradients_(gradients),
        features_(memory),
        planes_(memory),
        filtered_(memory) {}

  void configure(const AsvgfSettings& settings);
  PassDeclaration declaration() const override;
  size_t memory_bytes() const override;

 private:
  bool find_changes(const FrameContext& frame) override;
  void limit_history(const FrameContext& frame, LightPart part, LightHistory& history) override;
  // Returns false if a stop was requested first.
  bool prepare_gradients(const FrameContext& frame);

  AsvgfSettings settings_;
  const GradientPass* gradients_;
  Array<float> features_;
  Array<float> planes_;
  Array<float> filtered_;
};

}  // namespace relume
