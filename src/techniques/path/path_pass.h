// The estimator "path" as a pass.
#pragma once

#include "pipeline/pass.h"
#include "techniques/direction_sampler.h"
#include "techniques/light_selector.h"
#include "techniques/path/path_settings.h"

namespace relume {

/// Traces one path for each pixel that the allocation gives one. The settings and the choices of the other slots stay
/// with their owners and are read each frame.
class PathPass final : public Pass {
 public:
  /// `first_vertices`: also leave what each path found at its first vertex, for histories.
  PathPass(const PathSettings& settings, const LightSelector& selector, const DirectionSampler& directions,
           bool first_vertices)
      : settings_(settings), selector_(selector), directions_(directions), first_vertices_(first_vertices) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  const PathSettings& settings_;
  const LightSelector& selector_;
  const DirectionSampler& directions_;
  bool first_vertices_;
};

/// Buffers that every estimator owns: "radiance" and "rays" of this frame's sample.
std::vector<BufferDescription> estimator_buffers();

}  // namespace relume
