// The pass of the estimators "bdpt" and "light".
#pragma once

#include <algorithm>
#include <vector>

#include "core/array.h"
#include "frame/pass.h"
#include "frame/primitives/primitive.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/transport/bdpt/bdpt.h"
#include "techniques/transport/bdpt/settings.h"
#include "techniques/transport/bdpt/subpath_samples.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

enum class BdptMode : uint8_t {
  bidirectional,
  light_only,  ///< light tracing
};

/// Outputs besides estimator_buffers().
struct BdptRecords {
  bool splats = false;            ///< fills kLightRadiance, for a history that stores splats separately
  bool caustics = false;          ///< the caustic layer: splats, and merged light of specular light subpaths
  bool first_vertices = false;    ///< fills kFirstVertices, for a history that verifies pixels
  bool splats_apart = false;      ///< records a direction of splats separately, because cells lack their light
  bool first_scatters = false;    ///< fills kFirstScatters, and leaves the direct light of primary hits to reservoirs
  bool indirect_samples = false;  ///< fills kIndirectSamples, and leaves their light to reservoirs
  ChainRecordings chains = {};    ///< destinations of new states of camera subpaths
};

/// Faulty splats of one frame.
struct SplatFaults {
  uint64_t saturated = 0;  ///< clamped
  uint64_t nonfinite = 0;  ///< left out
};

/// Traces one light and one camera subpath for each pixel that receives a sample.
class BdptPass : public Pass {
 public:
  /// `recording`: destination of samples for learning; nullptr: none.
  BdptPass(const BdptSettings& settings, const LightSelectionSettings& selection, BdptMode mode,
           const PathSource& source, const PathRecording* recording, const BdptRecords& records, Memory& memory)
      : settings_(settings),
        selection_(selection),
        mode_(mode),
        source_(source),
        recording_(recording),
        records_(records),
        emission_(memory),
        connection_(memory),
        light_medium_(memory),
        vertices_(memory),
        to_camera_(memory),
        guides_(memory),
        faults_(memory) {
    if (records.first_scatters) source_.first_nee_bounce = 1;
    source_.indirect_to_reservoirs = records.indirect_samples;
  }

  void configure(const BdptSettings& settings) { settings_ = settings; }
  void configure(const LightSelectionSettings& selection) { selection_ = selection; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  void abandon() override;
  bool keeps_to_pixels() const override { return false; }
  size_t memory_bytes() const override {
    return emission_.memory_bytes() + connection_.memory_bytes() + light_medium_.memory_bytes() +
           vertices_.memory_bytes() + to_camera_.memory_bytes() + guides_.memory_bytes() + scratch_.memory_bytes();
  }
  std::vector<std::string> warnings() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

 protected:
  /// Completes the kernel for this frame. `samples`: pixels that receive a sample. Returns the number of light
  /// subpaths.
  virtual uint64_t prepare_subpaths(const FrameContext& frame, uint64_t samples, BdptKernel& kernel);
  /// Traces all subpaths. Returns false if a stop was requested.
  virtual bool trace(const FrameContext& frame, const BdptKernel& kernel);
  /// Launches the kernel with another output. Returns false if a stop was requested.
  template <typename Sink>
  bool trace_into(const FrameContext& frame, const BdptKernel& kernel, const Sink& sink) const;
  /// Whether camera subpaths record samples of indirect light, and the output that stores them.
  bool samples_indirect_light() const { return records_.indirect_samples; }
  static SubpathSamples samples_output(const FrameContext& frame, const BdptKernel& kernel);
  /// Whether trace() writes merged light to the caustic layer.
  virtual bool merges() const { return false; }
  /// Camera subpaths over which a pixel averages in a frame. Weights count the camera's strategies as often.
  virtual float averaged_subpaths() const { return 1.0f; }
  /// Whether an image adds samples of a pixel to splats of other frames, so that the weights of all frames must agree.
  virtual bool mixes_frames() const { return records_.splats; }
  /// Views of the caustic layer; empty if it is not wanted.
  CausticViews caustics(const FrameContext& frame) const;
  bool learns() const { return recording_ || records_.chains.any(); }
  /// Whether weights use the density of directions that quadtrees guide, which changes with each frame.
  bool weighs_guide() const {
    return learns() && source_.directions.kind == DirectionSamplerKind::quadtree && !mixes_frames();
  }
  LearningContext learning(const BdptContext& context) const;
  /// Completes the records of first vertices. Returns false if a stop was requested.
  virtual bool record_first_vertices(const FrameContext& frame, const BdptKernel& kernel) const;

 private:
  /// Launches the kernel in bands of rows for whose light subpaths there is memory.
  template <typename Context, typename Sink>
  static bool trace_in_bands(const FrameContext& frame, const BidirectionalKernel<Context, Sink>& kernel);
  void prepare_lights(const FrameContext& frame);
  /// Clears the records of first vertices and their choices, for this frame.
  FirstLight begin_first_light(const FrameContext& frame, float splat_scale) const;

  BdptSettings settings_;
  LightSelectionSettings selection_;
  BdptMode mode_;
  PathSource source_;
  const PathRecording* recording_;
  BdptRecords records_;
  Array<AliasEntry> emission_;    ///< by power; for light tracing with a constant environment
  Array<AliasEntry> connection_;  ///< by power, over the lights that connections sample
  Array<Rgb> light_medium_;       ///< per light; empty: the scene has no tinted media
  Array<PathVertex> vertices_;    ///< of the light subpaths of one launch; empty if the host's stack holds them
  Array<CameraConnection> to_camera_;
  Array<GuidedPoint> guides_;  ///< by vertex; empty: weights do not use guiding
  KernelValue<SplatFaults> faults_;
  PrimitiveScratch scratch_;
  bool prepared_ = false;
  bool has_splats_ = false;   ///< whether a frame that was stopped or failed has left splats
  SplatFaults frame_faults_;  ///< of the last frame; 0 if it was abandoned
  uint64_t saturated_ = 0;    ///< splats clamped so far
  uint64_t nonfinite_ = 0;    ///< splats left out so far
};

template <typename Sink>
bool BdptPass::trace_into(const FrameContext& frame, const BdptKernel& kernel, const Sink& sink) const {
  if (learns()) return trace_in_bands(frame, kernel.with(learning(kernel.context), sink));
  return trace_in_bands(frame, kernel.with(kernel.context, sink));
}

template <typename Context, typename Sink>
bool BdptPass::trace_in_bands(const FrameContext& frame, const BidirectionalKernel<Context, Sink>& kernel) {
  if (kernel.kept_rows == 0) return frame.launch_or_stop("trace", kernel);
  Tile band = frame.rendered();
  for (const uint32_t end = band.y1; band.y0 < end; band.y0 = band.y1) {
    band.y1 = std::min(band.y0 + kernel.kept_rows, end);
    if (!launch(frame.backend, "trace", kernel, band, frame.stop)) return false;
  }
  return true;
}

}  // namespace relume
