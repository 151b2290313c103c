// Primary hits and their surfaces as passes.
#pragma once

#include "frame/pass.h"

namespace relume {

/// Means over the frames since the last change, for AOVs.
inline constexpr BufferKey<Rgb> kAlbedoAov{"albedo"};
inline constexpr BufferKey<Vec3> kNormalAov{"normal"};
inline constexpr BufferKey<float> kDepthAov{"depth"};
/// Of the last frame.
inline constexpr BufferKey<Vec2> kMotionAov{"motion"};

/// Traces the camera rays.
class PrimaryHitsPass final : public Pass {
 public:
  /// `only_samples`: only those of pixels that get a sample.
  explicit PrimaryHitsPass(bool only_samples) : only_samples_(only_samples) {}
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  bool only_samples_;
};

/// A buffer of what camera rays met; double-buffered ones keep the previous frame.
BufferDescription surface_buffer(const BufferId& id, const char* help, bool double_buffered,
                                 std::string_view channels = "");

/// What they met, for whoever filters, reprojects or shows it. Part of a frame only if another pass reads it.
class SurfacePass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

/// Averages of the same, as AOVs.
class AuxiliaryPass final : public Pass {
 public:
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
};

}  // namespace relume
