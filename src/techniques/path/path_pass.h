// The estimator "path" as a pass.
#pragma once

#include "pipeline/pass.h"
#include "techniques/direction_sampling/direction_sampler.h"
#include "techniques/light_selection/light_selector.h"
#include "techniques/octree/path_recording.h"
#include "techniques/path/settings.h"

namespace relume {

struct PathContext;

/// Where paths get their settings and samplers from; what they refer to stays with its owners and is read each frame.
struct PathSource {
  const PathSettings& settings;
  const LightSelector& selector;
  const DirectionSampler& directions;
};

/// What paths of this frame have in common.
PathContext make_path_context(const PathSource& source, const FrameContext& frame);

/// Traces one path for each pixel that the allocation gives one.
class PathPass final : public Pass {
 public:
  /// `first_vertices`: also leave what each path found at its first vertex, for histories. `recording`: where paths
  /// leave samples to learn from; nullptr if nobody does.
  PathPass(const PathSource& source, bool first_vertices, const PathRecording* recording = nullptr)
      : source_(source), first_vertices_(first_vertices), recording_(recording) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  PathSource source_;
  bool first_vertices_;
  const PathRecording* recording_;
};

/// Buffers that every estimator owns: "radiance" and "rays" of this frame's sample.
std::vector<BufferDescription> estimator_buffers();

}  // namespace relume
