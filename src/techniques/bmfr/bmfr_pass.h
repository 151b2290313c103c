// The denoiser "bmfr" as a pass.
#pragma once

#include <vector>

#include "pipeline/pass.h"
#include "techniques/bmfr/settings.h"
#include "techniques/features/find_light_change.h"

namespace relume {

class BmfrPass final : public Pass {
 public:
  explicit BmfrPass(const BmfrSettings& settings) : settings_(settings) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return noise_.size() * sizeof(float) + change_.memory_bytes(); }

 private:
  void accumulate(const FrameContext& frame);
  void fit(const FrameContext& frame);
  void present(const FrameContext& frame) const;

  const BmfrSettings& settings_;
  LightChange change_;
  std::vector<float> noise_;
};

}  // namespace relume
