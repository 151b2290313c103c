// The denoiser "svgf" as a pass.
#pragma once

#include <vector>

#include "pipeline/pass.h"
#include "techniques/features/find_light_change.h"
#include "techniques/svgf/settings.h"

namespace relume {

class SvgfPass final : public Pass {
 public:
  explicit SvgfPass(const SvgfSettings& settings) : settings_(settings) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return (features_.size() + light_.size() + filtered_.size()) * sizeof(float) + change_.memory_bytes();
  }

 private:
  void accumulate(const FrameContext& frame);
  void prepare(const FrameContext& frame);
  void filter(const FrameContext& frame);
  void present(const FrameContext& frame);

  const SvgfSettings& settings_;
  LightChange change_;
  std::vector<float> features_;
  std::vector<float> light_;
  std::vector<float> filtered_;
};

}  // namespace relume
