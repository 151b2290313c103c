// The passes for primary hits, their surface properties and auxiliary layers.
#pragma once

#include "frame/pass.h"

namespace relume {

/// Auxiliary layers: means over the samples since the last change.
inline constexpr BufferKey<Rgb> kAlbedoAov{"albedo"};
inline constexpr BufferKey<Vec3> kNormalAov{"normal"};
inline constexpr BufferKey<float> kDepthAov{"depth"};
/// Of the first sample after the last change.
inline constexpr BufferKey<Vec2> kMotionAov{"motion"};

/// Traces the camera rays.
class PrimaryHitsPass final : public Pass {
 public:
  /// `only_samples`: only for pixels that receive a sample.
  explicit PrimaryHitsPass(bool only_samples) : only_samples_(only_samples) {}
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  bool only_samples_;
};

/// A buffer of surface properties; double-buffered ones keep the previous frame.
BufferDescription surface_buffer(const BufferId& id, const char* help, bool double_buffered,
                                 std::string_view channels = "");

/// Writes the surface properties of hits, if another pass reads them.
class SurfacePass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

/// Accumulates the auxiliary layers.
class AuxiliaryPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

}  // namespace relume
