// BMFR as a pass.
#pragma once

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/denoise/bmfr/bmfr.h"
#include "techniques/denoise/bmfr/settings.h"
#include "techniques/denoise/shared/denoiser_buffers.h"
#include "techniques/denoise/shared/find_light_change.h"

namespace relume {

class BmfrPass final : public Pass {
 public:
  /// `split`: keeps diffuse and specular light apart.
  BmfrPass(const BmfrSettings& settings, bool split, Memory& memory)
      : settings_(settings), split_(split), change_{LightChange(memory), LightChange(memory)}, noise_(memory) {}

  void configure(const BmfrSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  void abandon() override {
    if (split_) reflecting_.abandon_frame();
  }
  size_t memory_bytes() const override {
    return noise_.memory_bytes() + change_[0].memory_bytes() + change_[1].memory_bytes() + scratch_.memory_bytes();
  }

 private:
  void accumulate(const FrameContext& frame, LightPart part);
  /// False if a stop was requested first, also for present().
  bool fit(const FrameContext& frame, LightPart part);
  bool present(const FrameContext& frame);
  void clear_specular(const FrameContext& frame) const;
  bool present_parts(const FrameContext& frame);
  FitHistory fit_history(const FrameContext& frame, LightPart part) const;

  BmfrSettings settings_;
  bool split_;
  ReflectingFrames reflecting_;
  PrimitiveScratch scratch_;
  LightChange change_[2];  ///< changes of light without the specular part, and of specular light
  Array<float> noise_;
};

}  // namespace relume
