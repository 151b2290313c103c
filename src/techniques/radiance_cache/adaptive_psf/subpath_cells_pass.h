// The caches "psf" and "apsf" with the estimators "bdpt" and "vcm" as passes.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/settings.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/transport/bdpt/bdpt_pass.h"
#include "techniques/transport/vcm/vcm_pass.h"

namespace relume {

struct SubpathCells;

/// The cells that camera subpaths fill, and the survival of these subpaths.
struct CellsOfSubpaths {
  const CellsPass& cells;
  bool adapts = false;  ///< whether `settings` apply: apsf
  AdaptivePsfSettings settings = {};

  /// Output for the kernel of a frame, without samples for reservoirs.
  SubpathCells output(const FrameContext& frame) const;
  /// As BdptPass::record_first_vertices().
  bool record_first_vertices(const FrameContext& frame, const BdptKernel& kernel) const;
};

/// Traces one light and one camera subpath for each pixel that receives a sample, and fills the cells.
class BdptCellsPass final : public BdptPass {
 public:
  /// `adapts`: whether `apsf` applies. The other arguments are those of BdptPass.
  BdptCellsPass(const BdptSettings& settings, const LightSelectionSettings& selection, const AdaptivePsfSettings& apsf,
                bool adapts, const CellsPass& cells, const PathSource& source, const PathRecording* recording,
                const BdptRecords& records, Memory& memory)
      : BdptPass(settings, selection, BdptMode::bidirectional, source, recording, records, memory),
        cells_{cells, adapts, apsf} {}

  using BdptPass::configure;
  void configure(const AdaptivePsfSettings& settings) { cells_.settings = settings; }
  PassDeclaration declaration() const override;

 protected:
  bool trace(const FrameContext& frame, const BdptKernel& kernel) override;
  bool record_first_vertices(const FrameContext& frame, const BdptKernel& kernel) const override {
    return cells_.record_first_vertices(frame, kernel);
  }
  float averaged_subpaths() const override { return cells_.cells.samples_per_frame(); }
  bool mixes_frames() const override { return true; }

 private:
  CellsOfSubpaths cells_;
};

/// Traces light subpaths, and a camera subpath for each pixel that receives a sample, and fills the cells.
class VcmCellsPass final : public VcmPass {
 public:
  /// `adapts`: whether `apsf` applies. The other arguments are those of VcmPass.
  VcmCellsPass(const VcmSettings& settings, const BdptSettings& bdpt, const LightSelectionSettings& selection,
               const AdaptivePsfSettings& apsf, bool adapts, const CellsPass& cells, bool accumulates,
               const PathSource& source, const PathRecording* recording, const BdptRecords& records, Memory& memory)
      : VcmPass(settings, bdpt, selection, accumulates, source, recording, records, memory),
        cells_{cells, adapts, apsf} {}

  using VcmPass::configure;
  void configure(const AdaptivePsfSettings& settings) { cells_.settings = settings; }
  PassDeclaration declaration() const override;

 protected:
  bool trace(const FrameContext& frame, const BdptKernel& kernel) override;
  bool record_first_vertices(const FrameContext& frame, const BdptKernel& kernel) const override {
    return cells_.record_first_vertices(frame, kernel);
  }
  float averaged_subpaths() const override { return cells_.cells.samples_per_frame(); }
  bool mixes_frames() const override { return true; }
  bool merges() const override { return false; }  // merged light is in cells

 private:
  CellsOfSubpaths cells_;
};

}  // namespace relume
