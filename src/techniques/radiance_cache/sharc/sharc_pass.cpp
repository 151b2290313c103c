#include "techniques/radiance_cache/sharc/sharc_pass.h"

#include <algorithm>

#include "techniques/radiance_cache/sharc/cell_ends.h"
#include "techniques/radiance_cache/sharc/cell_update.h"

namespace relume {
namespace {

/// Edge of the square of blocks per task: each traces a path.
constexpr uint32_t kUpdateTile = 8;

}  // namespace

CellDepths cell_depths(const SharcSettings& settings) {
  // One path per block, with more blocks than pixels / 25 in narrow images.
  return {settings.update == SharcUpdate::sparse ? 2u : kMostUpdatedCells};
}

CellEnds make_cell_ends(const SharcSettings& settings, const FilterContext& filter, const View<float>& termination) {
  return {.cells = {filter.grid, filter.narrow_alpha},
          .by_variance = settings.end == SharcEnd::variance,
          .variance = settings.variance,
          .termination = termination};
}

PassDeclaration SharcPass::declaration() const {
  PassDeclaration declaration{.name = "trace",
                              .stage = Stage::trace,
                              .owns = estimator_buffers(),
                              .reads = {kPrimaryHits},
                              .reads_if_any = {kAllocation},
                              .only_sampled_pixels = true};
  declaration.owns.push_back({.id = kCellTermination, .help = kCellTerminationHelp, .display = BufferDisplay::value});
  if (cells_.users().history) declaration.owns.push_back(first_vertices_buffer());
  if (cells_.users().reservoirs) declaration.owns.push_back(first_scatters_buffer());
  if (cells_.users().indirect) declaration.owns.push_back(indirect_samples_buffer());
  return declaration;
}

bool SharcPass::run(const FrameContext& frame) {
  // Updates write keys and sums. Camera paths read histories, which are empty behind a new key, so the order of both
  // launches changes no bit.
  return trace(frame) && update_cells(frame);
}

bool SharcPass::trace(const FrameContext& frame) const {
  const CellEnds ends = make_cell_ends(settings_, cells_.filter(), frame.write(kCellTermination));
  const RadianceOutput radiance{frame.write(kRadiance)};
  OptionalOutput<FirstScatterOutput> scatters;
  if (cells_.users().reservoirs) scatters = {{frame.write(kFirstScatters)}, true};
  OptionalOutput<FirstVertexOutput> vertices;
  if (cells_.users().history) vertices = {{frame.write(kFirstVertices)}, true};
  // With reservoirs of whole paths, only their candidates record samples.
  const LearningRecords records = cells_.users().whole_paths ? LearningRecords{} : learning_;
  if (cells_.users().indirect) {
    const IndirectSampleOutput samples{frame.write(kIndirectSamples)};
    if (records.any())
      return trace_recorded_paths(source_, frame, records, radiance, scatters, samples, vertices, ends);
    return trace_paths(source_, frame, nullptr, radiance, scatters, samples, vertices, ends);
  }
  if (records.any()) return trace_recorded_paths(source_, frame, records, radiance, scatters, vertices, ends);
  const auto trace_with = [&](const auto&... outputs) {
    if (!vertices.active) return trace_paths(source_, frame, nullptr, outputs..., ends);
    return trace_paths(source_, frame, nullptr, outputs..., vertices.output, ends);
  };
  return scatters.active ? trace_with(radiance, scatters.output) : trace_with(radiance);
}

bool SharcPass::update_cells(const FrameContext& frame) const {
  constexpr uint32_t kSalt = 0x7a3c9e15u;
  CellUpdateKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.context.indirect = {};         // every update path continues
  kernel.context.first_nee_bounce = 0;  // cells receive all direct light, which reservoirs only add to pixels
  kernel.context.indirect_to_reservoirs = false;
  kernel.context.only_specular = false;
  kernel.context.max_bounces = std::max(kernel.context.max_bounces, kLeastUpdateBounces);
  kernel.update = {.cells = {cells_.filter().grid, cells_.filter().narrow_alpha},
                   .depth = static_cast<uint32_t>(settings_.propagation_depth),
                   .feedback = settings_.feedback,
                   .clamp = settings_.clamp,
                   .inherits = includes(frame.changes, Change::camera)};
  if (learning_.samples) kernel.update.regions = learning_.samples->lookup;
  kernel.index = frame.index;
  kernel.paths = frame.index;
  kernel.paths.seed = hash(frame.index.seed, kSalt);
  kernel.hits = frame.read(kPrimaryHits);
  kernel.allocation = frame.read(kAllocation);
  kernel.rays = frame.write(kRays);
  kernel.block = settings_.update == SharcUpdate::sparse ? kUpdateBlock : 1u;
  kernel.width = frame.width();
  kernel.height = frame.height();
  const Grid grid{update_blocks(frame.width(), kernel.block), update_blocks(frame.height(), kernel.block), kUpdateTile};
  return frame.launch_or_stop("update", kernel, grid);
}

bool MaintainSharcPass::run(const FrameContext& frame) {
  cells_.advance(frame);
  cells_.adjust_size(frame.backend);
  return true;
}

}  // namespace relume
