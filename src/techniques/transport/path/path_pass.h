// The pass of the estimator "path".
#pragma once

#include "frame/pass.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/path/settings.h"

namespace relume {

class FirstSurfaces;
struct ChainOutput;
struct GuideRecording;
struct LightChainRecording;
struct PathContext;

/// Inputs of path tracing. The samplers belong to passes that prepare them every frame.
struct PathSource {
  PathSettings settings;
  const LightSelector& selector;
  const DirectionSampler& directions;
  uint32_t first_nee_bounce = 0;        ///< as in PathContext
  uint32_t light_candidates = 1;        ///< as in PathContext
  bool indirect_to_reservoirs = false;  ///< as in PathContext
  bool only_specular = false;           ///< as in PathContext
};

/// Number of lights that paths sample at a primary hit (PathContext::light_candidates).
struct PrimaryLightCandidates {
  uint32_t count = 1;
};

/// Data shared by all paths of this frame.
PathContext make_path_context(const PathSource& source, const FrameContext& frame);

/// Destinations of new states for Markov chains; nullptr: none.
struct ChainRecordings {
  const GuideRecording* guide = nullptr;
  const LightChainRecording* lights = nullptr;

  bool any() const { return guide || lights; }
};

/// Output of these states; its parts without a destination record nothing.
ChainOutput chain_output(const ChainRecordings& chains);

/// Outputs of paths for later passes, besides estimator_buffers().
struct PathRecords {
  bool first_vertices = false;    ///< fills kFirstVertices
  bool specular = false;          ///< fills kRadianceSpecular
  bool first_scatters = false;    ///< fills kFirstScatters, and leaves the direct light of primary hits to reservoirs
  bool indirect_samples = false;  ///< fills kIndirectSamples, and leaves light beyond second vertices to reservoirs
  bool only_specular = false;     ///< leaves all light that lobes with a density scatter to reservoirs
};

/// Traces one path for each pixel that receives a sample.
class PathPass final : public Pass {
 public:
  /// `recording`: destination of samples for learning; nullptr: none.
  PathPass(const PathSource& source, const PathRecords& records, const PathRecording* recording = nullptr,
           const ChainRecordings& chains = {})
      : source_(source), records_(records), recording_(recording), chains_(chains) {
    if (records.first_scatters) source_.first_nee_bounce = 1;
    source_.indirect_to_reservoirs = records.indirect_samples;
    source_.only_specular = records.only_specular;
  }

  void configure(const PathSettings& path) { source_.settings = path; }
  /// From now on, `surfaces` receives the surfaces at primary hits in each frame that expects them. It must outlive
  /// this pass.
  void hand_surfaces_to(const FirstSurfaces& surfaces) { surfaces_ = &surfaces; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  PathSource source_;
  PathRecords records_;
  const PathRecording* recording_;
  ChainRecordings chains_;
  const FirstSurfaces* surfaces_ = nullptr;
};

/// Buffers owned by every estimator: kRadiance and kRays of this frame's sample.
std::vector<BufferDescription> estimator_buffers();

/// kFirstVertices, kFirstScatters and kIndirectSamples. The pass that traces paths owns them if later passes need them.
BufferDescription first_vertices_buffer();
BufferDescription first_scatters_buffer();
BufferDescription indirect_samples_buffer();

}  // namespace relume
