// The cache "psf" as a pass.
#pragma once

#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Traces one path for each pixel that receives a sample, and adds its radiance to the cells.
class PathSpaceFilterPass final : public Pass {
 public:
  /// `records`: as for trace_into_cells().
  PathSpaceFilterPass(const PathSource& source, const CellsPass& cells, const LearningRecords& records)
      : source_(source), cells_(cells), records_(records) {}

  void configure(const PathSettings& path) { source_.settings = path; }
  void configure(const PrimaryLightCandidates& candidates) { source_.light_candidates = candidates.count; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  PathSource source_;
  const CellsPass& cells_;
  LearningRecords records_;
};

}  // namespace relume
