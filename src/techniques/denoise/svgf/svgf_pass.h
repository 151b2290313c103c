// SVGF as a pass.
#pragma once

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/denoise/shared/denoiser_buffers.h"
#include "techniques/denoise/shared/find_light_change.h"
#include "techniques/denoise/svgf/settings.h"

namespace relume {

class SvgfPass : public Pass {
 public:
  /// `split`: keeps diffuse and specular light apart.
  SvgfPass(const SvgfSettings& settings, bool split, Memory& memory)
      : settings_(settings),
        split_(split),
        change_{LightChange(memory), LightChange(memory)},
        features_(memory),
        light_{Array<float>(memory), Array<float>(memory)},
        filtered_(memory) {}

  void configure(const SvgfSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  void abandon() override {
    if (split_) reflecting_.abandon_frame();
  }
  size_t memory_bytes() const override {
    return features_.memory_bytes() + light_[0].memory_bytes() + light_[1].memory_bytes() + filtered_.memory_bytes() +
           change_[0].memory_bytes() + change_[1].memory_bytes() + scratch_.memory_bytes();
  }

 protected:
  /// Prepares limit_history(). Returns false if a stop was requested first.
  virtual bool find_changes(const FrameContext& /*frame*/) { return true; }
  /// Shortens the history of pixels whose light has changed, here by the changes of blocks (light_change.h).
  virtual void limit_history(const FrameContext& frame, LightPart part, LightHistory& history);

 private:
  // These return false if a stop was requested first.
  bool accumulate(const FrameContext& frame, LightPart part);
  bool prepare(const FrameContext& frame, LightPart part);
  bool present(const FrameContext& frame);
  void clear_specular(const FrameContext& frame) const;
  bool present_parts(const FrameContext& frame);
  /// Index of the buffers of a part: 1 for specular light, else 0.
  static size_t place_of(LightPart part) { return part == LightPart::specular ? 1 : 0; }

  SvgfSettings settings_;
  bool split_;
  ReflectingFrames reflecting_;
  PrimitiveScratch scratch_;
  LightChange change_[2];
  Array<float> features_;
  Array<float> light_[2];
  Array<float> filtered_;
};

}  // namespace relume
