// Temporal upscaling as passes.
#pragma once

#include "frame/pass.h"
#include "techniques/temporal/upscaling/settings.h"

namespace relume {

/// Chooses the pixels that get a sample.
class BlockAllocationPass final : public Pass {
 public:
  explicit BlockAllocationPass(const UpscalingSettings& settings) : settings_(settings) {}

  void configure(const UpscalingSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  UpscalingSettings settings_;
};

/// Fills pixels without samples, for images that no denoiser with its own history fills.
class FillUnsampledPass final : public Pass {
 public:
  explicit FillUnsampledPass(const UpscalingSettings& settings) : settings_(settings) {}

  void configure(const UpscalingSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  UpscalingSettings settings_;
};

}  // namespace relume
