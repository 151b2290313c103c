// The specular part of the history "reproject" as three passes: around the one that moves the mean, and after samples
// have joined it. See specular_history.h.
#pragma once

#include <vector>

#include "frame/pass.h"
#include "techniques/temporal/reprojection/settings.h"

namespace relume {

/// Stands before ReprojectionPass.
class DetachSpecularPass final : public Pass {
 public:
  explicit DetachSpecularPass(const ReprojectionSettings& settings) : settings_(settings) {}

  void configure(const ReprojectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return specular_before_.capacity() * sizeof(Rgb) + samples_before_.capacity() * sizeof(uint32_t);
  }

 private:
  ReprojectionSettings settings_;
  std::vector<Rgb> specular_before_;
  std::vector<uint32_t> samples_before_;
};

/// Stands behind ReprojectionPass.
class AttachSpecularPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

/// Stands behind AccumulatePass.
class AccumulateSpecularPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

}  // namespace relume
