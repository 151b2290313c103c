// The passes before and after the paths of caches in a hash grid. One prepares the grid; the other computes pixels from
// cells and maintains the grid.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"
#include "techniques/radiance_cache/path_space_filter/sampled_cells.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/radiance_cache/path_space_filter/verified_cells.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/transport/path/path_pass.h"
#include "techniques/transport/path/recording_output.h"
#include "techniques/transport/path/scatter_chances.h"
#include "techniques/transport/path/trace_paths.h"

namespace relume {

/// Results of each pixel's path for ResolveCellsPass.
inline constexpr BufferKey<FilteredPixel> kFilteredPixels{"filtered-pixels"};
/// Bounce, from 1, at which the contribution of each pixel's path ended.
inline constexpr BufferKey<float> kCellTermination{"cell-termination"};
inline constexpr const char* kCellTerminationHelp =
    "bounce, from 1, after which the pixel's path no longer contributes";

/// Number of path vertices per pixel with separate cells, for the size of the table.
struct CellDepths {
  uint32_t count = 1;
};

/// Consumers for which paths that fill or read cells write more outputs.
struct CellPathUsers {
  bool history = false;      ///< a history that verifies pixels
  bool reservoirs = false;   ///< reservoirs that add the direct light of primary hits, which paths leave out
  bool indirect = false;     ///< the same for their indirect light
  bool whole_paths = false;  ///< reservoirs that add all light that lobes with a density scatter, as
                             ///< PathRecords::only_specular

  bool any_reservoirs() const { return reservoirs || indirect || whole_paths; }
};

/// Owns the cells. Its longest_epoch() is 0: all frames continue one low-discrepancy sequence per pixel, because images
/// of one sample need its stratification. Of a cell's samples, only one in hundreds is an earlier one of the same
/// pixel.
class CellsPass final : public Pass {
 public:
  /// `depths`: as CellDepths. `prefix`: of the settings that warnings name.
  CellsPass(const PathSpaceFilterSettings& settings, uint32_t depths, const CellPathUsers& users,
            std::string_view prefix, Memory& memory)
      : settings_(settings), depths_(depths), users_(users), prefix_(prefix), grid_(memory), others_(memory) {}
  CellsPass(const PathSpaceFilterSettings& settings, uint32_t depths, const CellPathUsers& users, Memory& memory)
      : CellsPass(settings, depths, users, "psf", memory) {}

  void configure(const PathSpaceFilterSettings& settings) { settings_ = settings; }
  void configure(const CellDepths& depths) { depths_ = depths.count; }
  PassDeclaration declaration() const override { return {.name = "cells", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override;
  bool keeps_to_pixels() const override { return false; }
  size_t memory_bytes() const override;
  std::vector<PassStatistic> statistics() const override;
  std::vector<PassRecords> records() const override;
  std::vector<std::string> warnings() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Valid after the first run().
  const FilterContext& filter() const { return filter_; }
  const CellPathUsers& users() const { return users_; }
  uint32_t edge_rays() const { return static_cast<uint32_t>(settings_.edge_rays); }
  /// The setting split, and the setting refine or 0. Cells of every vertex have neither.
  bool splits() const { return depths_ == 1 && settings_.split; }
  float refine() const { return depths_ == 1 ? settings_.refine : 0.0f; }
  /// Approximate number of a cell's samples per frame: the pixels that it covers.
  float samples_per_frame() const { return relume::max(1.0f, sqr(settings_.grid.cell_size)); }
  View<const OtherCells> others() const { return others_.view(); }
  /// Call after all samples of the frame. Moments that filter() reads then include them.
  void advance(const FrameContext& frame);
  /// Call when no slot is in use.
  void adjust_size(Backend& backend) { grid_.adjust_size(backend); }

 private:
  void allocate_others(uint32_t pixels);

  PathSpaceFilterSettings settings_;
  uint32_t depths_;
  CellPathUsers users_;
  std::string_view prefix_;  ///< a literal
  HashGrid grid_;
  uint32_t watched_frames_ = 0;  ///< remaining frames in which regions are tested for changes
  uint32_t watched_before_ = 0;  ///< the same before this frame
  bool ready_ = false;
  FilterContext filter_;
  Array<OtherCells> others_;  ///< by pixel; empty without split and finer cells
};

/// Computes pixels from paths and cells. Owns the layers that show cells.
class ResolveCellsPass final : public Pass {
 public:
  /// `sharpens_edges`: whether this pass traces more camera rays at edges of light sources. Denoisers trace their own.
  /// `adds`: whether kRadiance holds splats of light paths or the light of reservoirs, to which this pass adds
  /// the light of the cells.
  ResolveCellsPass(const PathSource& source, CellsPass& cells, bool sharpens_edges, bool adds)
      : source_(source), cells_(cells), sharpens_edges_(sharpens_edges), adds_(adds) {}

  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool commits() const override { return true; }
  std::vector<PassStatistic> statistics() const override;

 private:
  PathSource source_;
  CellsPass& cells_;
  bool sharpens_edges_;
  bool adds_;
  const Buffer* pixels_ = nullptr;  ///< pixels of the last frame
};

/// The buffer of FilteredPixel, which the pass that traces paths owns.
BufferDescription filtered_pixels_buffer();
/// The buffer kScatterChances, which that pass owns if reservoirs add the direct light of primary hits.
BufferDescription scatter_chances_buffer();
/// The buffer kCellsAtHit, which it owns for a history that verifies pixels.
BufferDescription cells_at_hit_buffer();

/// Declaration of a pass that traces paths and fills cells. It owns the buffers of estimators and kFilteredPixels, and
/// those for the users: of a history kFirstVertices and kCellsAtHit, of reservoirs of direct light kFirstScatters and
/// kScatterChances, of those of indirect light kIndirectSamples.
PassDeclaration cell_paths_declaration(const CellsPass& cells);

/// Destinations of what paths record for learning: samples for regions, and states for chains; nullptr: none.
struct LearningRecords {
  const PathRecording* samples = nullptr;
  ChainRecordings chains;

  bool any() const { return samples || chains.any(); }
};

/// Traces paths with `outputs` for each, which record samples and states. Without a destination, they record no
/// vertices.
template <typename... Outputs>
bool trace_recorded_paths(const PathSource& source, const FrameContext& frame, const LearningRecords& records,
                          const Outputs&... outputs) {
  CachedRecordingOutput samples;
  if (records.samples) samples.recording = *records.samples;
  const CachedChainOutput chains{chain_output(records.chains)};
  return trace_paths(source, frame, nullptr, samples, chains, outputs...);
}

/// Traces paths and fills `cells`; `cache` as for CellsOutput.
template <typename Cache>
bool trace_into_cells(const PathSource& source, const FrameContext& frame, const CellsPass& cells, const Cache& cache,
                      const LearningRecords& records) {
  PathSource traced = source;
  CellsOutput<Cache> output{cache, frame.write(kFilteredPixels)};
  ReservoirScatterOutput scatters;
  if (cells.users().reservoirs) {
    traced.first_nee_bounce = 1;
    output.scatter_chances = frame.write(kScatterChances);
    scatters = {{frame.write(kFirstScatters)}, true};
  }
  traced.indirect_to_reservoirs = cells.users().indirect;
  traced.only_specular = cells.users().whole_paths;
  if (cells.users().any_reservoirs()) output.radiance = frame.write(kRadiance);
  const auto trace = [&](const auto& paths) {
    if (cells.users().indirect) {
      const IndirectSampleOutput samples{frame.write(kIndirectSamples)};
      return trace_in_order<Cache>(paths, samples, [&](const auto& first, const auto& second) {
        return trace_recorded_paths(traced, frame, records, first, second, scatters);
      });
    }
    if (records.any()) return trace_recorded_paths(traced, frame, records, paths, scatters);
    return trace_paths(traced, frame, nullptr, paths, scatters);
  };
  if (!cells.users().history) return trace(output);
  return trace(VerifiedCellsOutput<Cache>{output, frame.write(kFirstVertices), frame.write(kCellsAtHit)});
}

}  // namespace relume
