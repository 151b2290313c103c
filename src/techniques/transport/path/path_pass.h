// The estimator "path" as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/path/settings.h"

namespace relume {

struct PathContext;

/// What paths are traced with. The samplers belong to passes that prepare them in each frame.
struct PathSource {
  PathSettings settings;
  const LightSelector& selector;
  const DirectionSampler& directions;
};

/// What paths of this frame have in common.
PathContext make_path_context(const PathSource& source, const FrameContext& frame);

/// What paths leave for later passes besides estimator_buffers().
struct PathRecords {
  bool first_vertices = false;  ///< fill kFirstVertices
  bool specular = false;        ///< fill kRadianceSpecular
};

/// Traces one path for each pixel that the allocation gives one.
class PathPass final : public Pass {
 public:
  /// `recording`: where paths store samples for learning; nullptr: they store none.
  PathPass(const PathSource& source, const PathRecords& records, const PathRecording* recording = nullptr)
      : source_(source), records_(records), recording_(recording) {}

  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  PathSource source_;
  PathRecords records_;
  const PathRecording* recording_;
};

/// Buffers that every estimator owns: kRadiance and kRays of this frame's sample.
std::vector<BufferDescription> estimator_buffers();

}  // namespace relume
