// The caches "apg" and "apsf+apg" as a pass.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/settings.h"
#include "techniques/radiance_cache/path_graphs/settings.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

struct PathGraphContext;

/// Ratio of all cells of path graphs to those of first vertices, for the size of the table. Later vertices also reach
/// surfaces outside the image: a ratio of 4 dropped eight thousand samples of Sponza's first frame.
inline constexpr uint32_t kGraphDepths = 8;

/// Constants of path graphs that fill the cells of `filter`, without survival at first vertices.
PathGraphContext make_path_graph(const PathGraphSettings& settings, const FilterContext& filter);

/// Traces one path graph for each pixel that receives a sample, and fills the cells.
class PathGraphPass final : public Pass {
 public:
  /// `primary`: survival and blend at the first vertex, if `adapts_primary`. `records`: as for trace_into_cells().
  PathGraphPass(const PathGraphSettings& settings, const AdaptivePsfSettings& primary, bool adapts_primary,
                const PathSource& source, const CellsPass& cells, const LearningRecords& records)
      : settings_(settings),
        primary_(primary),
        adapts_primary_(adapts_primary),
        source_(source),
        cells_(cells),
        records_(records) {}
  void configure(const AdaptivePsfSettings& primary) { primary_ = primary; }

  void configure(const PathGraphSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  void configure(const PrimaryLightCandidates& candidates) { source_.light_candidates = candidates.count; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  PathGraphSettings settings_;
  AdaptivePsfSettings primary_;
  bool adapts_primary_;
  PathSource source_;
  const CellsPass& cells_;
  LearningRecords records_;
};

}  // namespace relume
