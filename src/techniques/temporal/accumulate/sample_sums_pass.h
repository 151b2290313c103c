// Exact sums of samples as a pass.
#pragma once

#include "frame/pass.h"
#include "framebuffer/pixel_sums.h"

namespace relume {

inline constexpr BufferKey<SampleBlock> kSampleBlock{"sample-block"};
inline constexpr BufferKey<RadianceSums> kRadianceSums{"radiance-sums"};
inline constexpr BufferKey<SurfaceSums> kSurfaceSums{"surface-sums"};

/// Sums the samples since the last change. Every pixel has one per frame.
class SampleSumsPass final : public Pass {
 public:
  /// `surface`: also sums the layers of AuxiliaryPass.
  explicit SampleSumsPass(bool surface) : surface_(surface) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  bool surface_;
};

}  // namespace relume
