// The cache "sharc" as passes.
#pragma once

#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/radiance_cache/sharc/settings.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

struct CellEnds;

/// Cells per pixel to which the paths of a frame add samples at most: eight of each update path.
CellDepths cell_depths(const SharcSettings& settings);

/// Output of camera paths that end in the cells of `filter`. `termination`: as in CellEnds.
CellEnds make_cell_ends(const SharcSettings& settings, const FilterContext& filter, const View<float>& termination);

/// Traces one camera path for each pixel that receives a sample, and the update paths that fill the cells. Camera paths
/// read cells of earlier frames only.
class SharcPass final : public Pass {
 public:
  /// `learning`: destinations of the records of camera paths, unless reservoirs take whole paths. Camera paths also
  /// record first vertices, first scattering events and indirect samples for the users of `cells`.
  SharcPass(const SharcSettings& settings, const PathSource& source, const CellsPass& cells,
            const LearningRecords& learning)
      : settings_(settings), source_(source), cells_(cells), learning_(learning) {
    if (cells.users().reservoirs) source_.first_nee_bounce = 1;
    source_.indirect_to_reservoirs = cells.users().indirect;
    source_.only_specular = cells.users().whole_paths;
  }

  void configure(const SharcSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  // These return false if a stop was requested first.
  bool trace(const FrameContext& frame) const;
  bool update_cells(const FrameContext& frame) const;

  SharcSettings settings_;
  PathSource source_;
  const CellsPass& cells_;
  LearningRecords learning_;
};

/// Pools the samples of the frame with the cells.
class MaintainSharcPass final : public Pass {
 public:
  explicit MaintainSharcPass(CellsPass& cells) : cells_(cells) {}

  PassDeclaration declaration() const override { return {.name = "sharc", .stage = Stage::resolve}; }
  bool run(const FrameContext& frame) override;
  bool commits() const override { return true; }

 private:
  CellsPass& cells_;
};

}  // namespace relume
