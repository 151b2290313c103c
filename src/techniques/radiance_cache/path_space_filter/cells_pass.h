// The passes around the paths of every cache that keeps its cells in a hash grid: one makes the grid ready, one turns
// cells into pixels and keeps the grid in shape.
#pragma once

#include <memory>
#include <vector>

#include "frame/pass.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/transport/path/path_pass.h"
#include "techniques/transport/path/trace_paths.h"

namespace relume {

/// Per pixel, what its path leaves for the cells.
inline constexpr BufferKey<FilteredPixel> kFilteredPixels{"filtered-pixels"};
/// Per pixel, the bounce, from 1, at which its path ceased to count.
inline constexpr BufferKey<float> kCellTermination{"cell-termination"};

/// Owns the cells. Does not adapt() in the sense of Pass: frames go on with one low-discrepancy sequence a pixel, whose
/// evenness one sample a pixel lives on; a pixel's earlier samples are one in hundreds of those that its cell knows.
class CellsPass final : public Pass {
 public:
  /// `depths`: vertices of a path that have cells of their own; for the table's first size.
  CellsPass(const PathSpaceFilterSettings& settings, uint32_t depths) : settings_(settings), depths_(depths) {}

  void configure(const PathSpaceFilterSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "cells", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override;
  bool keeps_to_pixels() const override { return false; }
  size_t memory_bytes() const override;
  std::vector<PassStatistic> statistics() const override;
  std::vector<std::string> warnings() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Valid from the first run() on.
  const FilterContext& filter() const { return filter_; }
  uint32_t edge_rays() const { return static_cast<uint32_t>(settings_.edge_rays); }
  /// When all samples are in: what is read through filter() from then on includes them.
  void advance(const FrameContext& frame);
  /// When nobody knows slots any more.
  void adjust_size(Backend& backend) { grid_.adjust_size(backend); }

 private:
  PathSpaceFilterSettings settings_;
  uint32_t depths_;
  HashGrid grid_;
  uint32_t watched_frames_ = 0;  ///< for which cells still look for changes
  uint32_t watched_before_ = 0;  ///< the same before this frame
  bool ready_ = false;
  FilterContext filter_;
};

/// Shows the cells. Owns the layers that say what they are like.
class ResolveCellsPass final : public Pass {
 public:
  /// `sharpens_edges`: whether pixels at edges of emission get more camera rays here; denoisers see to that themselves.
  ResolveCellsPass(const PathSource& source, CellsPass& cells, bool sharpens_edges)
      : source_(source), cells_(cells), sharpens_edges_(sharpens_edges) {}

  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool commits() const override { return true; }
  std::vector<PassStatistic> statistics() const override;

 private:
  PathSource source_;
  CellsPass& cells_;
  bool sharpens_edges_;
  View<const FilteredPixel> pixels_;  ///< of the last frame
};

/// Of a pass that traces paths and fills cells: owns what estimators own, and what pixels leave for the cells.
PassDeclaration cell_paths_declaration();

/// Traces paths and fills cells; `cache` as for CellsOutput.
template <typename Cache>
bool trace_into_cells(const PathSource& source, const FrameContext& frame, const Cache& cache) {
  return trace_paths(source, frame, CellsOutput<Cache>{cache, frame.write(kFilteredPixels)});
}

}  // namespace relume
