// The pass of the estimator "vcm".
#pragma once

#include <vector>

#include "frame/primitives/group_by_key.h"
#include "techniques/transport/bdpt/bdpt_pass.h"
#include "techniques/transport/path/path_pass.h"
#include "techniques/transport/vcm/settings.h"
#include "techniques/transport/vcm/vcm.h"

namespace relume {

/// Number of light subpaths of a frame in which each of `pixels` > 0 pixels receives a sample. `kept`: maximum number
/// of vertices kept of one. `guided`: whether each has a GuidedPoint. At least 1, and at most one per pixel. Their
/// memory is below VcmSettings::memory_mib, except that of a single subpath.
uint64_t light_paths_of(const VcmSettings& settings, uint64_t pixels, uint32_t kept, bool guided = false);

/// Merging radius in frame `number` (from 0) since the last change, metres ([Hachisuka12], [Georgiev12]): r_n² = r_1²
/// n^(α − 1), with n = number + 1.
float merging_radius(const VcmSettings& settings, float scene_radius, uint32_t number);

/// Traces the light subpaths of the frame, sorts their vertices into a grid, and traces a camera subpath for each pixel
/// that receives a sample.
class VcmPass : public BdptPass {
 public:
  /// `accumulates`: whether frames add up, so that the radius may shrink. `recording`, `records`: as for BdptPass.
  VcmPass(const VcmSettings& settings, const BdptSettings& bdpt, const LightSelectionSettings& selection,
          bool accumulates, const PathSource& source, const PathRecording* recording, const BdptRecords& records,
          Memory& memory)
      : BdptPass(bdpt, selection, BdptMode::bidirectional, source, recording, records, memory),
        vcm_(settings),
        accumulates_(accumulates),
        light_vertices_(memory),
        guides_(memory),
        counts_(memory),
        keys_(memory),
        rays_(memory),
        sorted_(memory),
        groups_(memory) {}

  using BdptPass::configure;
  void configure(const VcmSettings& settings) { vcm_ = settings; }
  size_t memory_bytes() const override { return BdptPass::memory_bytes() + light_vertex_bytes(); }
  /// Bytes that VcmSettings::memory_mib limits.
  size_t light_vertex_bytes() const {
    return light_vertices_.memory_bytes() + guides_.memory_bytes() + counts_.memory_bytes() + keys_.memory_bytes() +
           rays_.memory_bytes() + sorted_.memory_bytes() + groups_.memory_bytes() + grid_scratch_.memory_bytes();
  }
  std::vector<PassStatistic> statistics() const override;

 protected:
  uint64_t prepare_subpaths(const FrameContext& frame, uint64_t samples, BdptKernel& kernel) override;
  bool trace(const FrameContext& frame, const BdptKernel& kernel) override;
  bool merges() const override { return true; }
  /// Traces and sorts the light subpaths, then launches the camera subpaths with another output. Returns false if a
  /// stop was requested.
  template <typename Sink>
  bool trace_into(const FrameContext& frame, const BdptKernel& kernel, const Sink& sink);

 private:
  /// Whether the frame sorts its light vertices.
  bool sorts() const { return paths_ > 0 && (radius_ > 0.0f || vcm_.connections > 0); }
  /// Traces and sorts the light subpaths, and completes `camera`. Returns false if a stop was requested.
  bool prepare_camera(const FrameContext& frame, const BdptKernel& kernel, VcmKernel& camera);
  template <typename Context>
  bool trace_light_subpaths(const FrameContext& frame, const BdptKernel& kernel, const Context& context,
                            const MergeGrid& grid);
  bool sort_vertices(const FrameContext& frame, LightVertexGrid& grid);

  VcmSettings vcm_;
  bool accumulates_;
  Array<PathVertex> light_vertices_;  ///< `stride_` slots per light subpath
  Array<GuidedPoint> guides_;         ///< by slot; empty: weights do not use guiding
  Array<uint32_t> counts_;            ///< vertices by light subpath
  Array<uint32_t> keys_;              ///< of the grid, by slot; empty: the frame does not sort
  Array<uint32_t> rays_;              ///< by light subpath
  Array<SortedVertex> sorted_;        ///< of all vertices that can merge
  KeyGroups groups_;
  PrimitiveScratch grid_scratch_;
  uint32_t stride_ = 0;
  uint32_t paths_ = 0;  ///< light subpaths of the frame
  float radius_ = 0;    ///< metres; 0: no merging
};

template <typename Sink>
bool VcmPass::trace_into(const FrameContext& frame, const BdptKernel& kernel, const Sink& sink) {
  VcmKernel camera;
  if (!prepare_camera(frame, kernel, camera)) return false;
  if (learns()) return frame.launch_or_stop("trace", camera.with(learning(kernel.context), sink));
  return frame.launch_or_stop("trace", camera.with(kernel.context, sink));
}

}  // namespace relume
