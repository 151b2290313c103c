// The cache "apsf" as a pass.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/settings.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Traces the surviving paths of the pixels that receive a sample, and adds their radiance to the cells.
class AdaptivePsfPass final : public Pass {
 public:
  /// `records`: as for trace_into_cells().
  AdaptivePsfPass(const AdaptivePsfSettings& settings, const PathSource& source, const CellsPass& cells,
                  const LearningRecords& records)
      : settings_(settings), source_(source), cells_(cells), records_(records) {}

  void configure(const AdaptivePsfSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  void configure(const PrimaryLightCandidates& candidates) { source_.light_candidates = candidates.count; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  AdaptivePsfSettings settings_;
  PathSource source_;
  const CellsPass& cells_;
  LearningRecords records_;
};

}  // namespace relume
