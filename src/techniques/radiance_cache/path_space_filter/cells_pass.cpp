#include "techniques/radiance_cache/path_space_filter/cells_pass.h"

#include <fmt/format.h>

#include "core/memory.h"
#include "core/stream_io.h"

namespace relume {
namespace {

/// Cells per patch of cell-size² pixels, with neighbours in reach of the jitter, other orientations and coarser levels.
constexpr float kCellsPerPatch = 4;

/// Frames after a change in which regions are tested, because light propagates from cell to cell.
constexpr uint32_t kWatchedFrames = 24;

constexpr BufferKey<uint32_t> kCellIdentity{"cell-identity"};
constexpr BufferKey<float> kCellLevel{"cell-level"};
constexpr BufferKey<float> kCellCount{"cell-count"};
constexpr BufferKey<float> kCellAge{"cell-age"};
constexpr BufferKey<float> kCellVariance{"cell-variance"};
constexpr BufferKey<float> kCellSurvival{"cell-survival"};
constexpr BufferKey<float> kCellBlend{"cell-blend"};
constexpr BufferKey<float> kCellOccupancy{"cell-occupancy"};

uint64_t expected_cells(const PathSpaceFilterSettings& settings, uint32_t pixels, uint32_t depths) {
  const float patches = static_cast<float>(pixels) / relume::max(1.0f, sqr(settings.grid.cell_size));
  return static_cast<uint64_t>(patches * kCellsPerPatch) * depths;
}

}  // namespace

bool CellsPass::run(const FrameContext& frame) {
  const uint32_t depths = depths_ + (splits() ? 1u : 0u) + (refine() > 0.0f ? 1u : 0u);
  const HashGridBounds bounds =
      bounds_for(frame.pixels(), depths, physical_memory_bytes(), settings_.grid.undersampled_cells);
  if (!ready_)
    grid_ = HashGrid(frame.backend, settings_.grid, expected_cells(settings_, frame.pixels(), depths), bounds);
  ready_ = true;
  grid_.configure(settings_.grid, bounds);
  if (includes(frame.changes, Change::settings)) grid_.clear(frame.backend);
  grid_.adjust_size(frame.backend);  // the limit may have changed
  watched_before_ = watched_frames_;
  if (watched_frames_ > 0) --watched_frames_;
  if (includes(frame.changes, Change::geometry | Change::lights | Change::materials)) watched_frames_ = kWatchedFrames;
  allocate_others(frame.pixels());
  filter_ = {.grid = grid_.view(frame.scene.camera),
             .narrow_alpha = sqr(settings_.min_roughness),
             .split = splits(),
             .refine = refine() > 0.0f,
             .others = others_.mutable_view(),
             .width = frame.width(),
             .direct_apart = users_.reservoirs,
             .indirect_apart = users_.indirect,
             .whole_apart = users_.whole_paths};
  return true;
}

void CellsPass::allocate_others(uint32_t pixels) {
  const bool needed = splits() || refine() > 0.0f;
  if (!needed) others_ = Array<OtherCells>(others_.memory());
  if (needed && others_.size() != pixels) others_.reset(pixels, kUninitialized);  // paths write before they read
}

void CellsPass::abandon() {
  grid_.abandon_frame();
  watched_frames_ = watched_before_;
}

void CellsPass::advance(const FrameContext& frame) {
  grid_.advance(frame.backend, watched_frames_ > 0);
  filter_.grid = grid_.view(frame.scene.camera);
}

size_t CellsPass::memory_bytes() const { return grid_.statistics().memory_bytes + others_.memory_bytes(); }

std::vector<PassStatistic> CellsPass::statistics() const {
  const HashGridStatistics s = grid_.statistics();
  return {{"slots", static_cast<double>(s.slots)},
          {"cells", static_cast<double>(s.cells)},
          {"occupancy", static_cast<double>(s.occupancy)},
          {"probes", static_cast<double>(s.mean_probes)},
          {"samples", static_cast<double>(s.samples)},
          {"inherited", static_cast<double>(s.inherited)},
          {"evicted", static_cast<double>(s.evicted)},
          {"discarded", static_cast<double>(s.discarded)},
          {"changed", static_cast<double>(s.changed)},
          {"dropped", static_cast<double>(s.dropped)},
          {"saturated", static_cast<double>(s.saturated)},
          {"nonfinite", static_cast<double>(s.nonfinite)},
          {"skipped-vertices", static_cast<double>(s.skipped_vertices)},
          {"rebuilds", static_cast<double>(s.rebuilds)},
          {"bytes", static_cast<double>(s.memory_bytes)}};
}

std::vector<PassRecords> CellsPass::records() const {
  using Record = HashGridRecord;
  return {pass_records<Record>("cells",
                               "a cell: its key, mean and mean square (of luminance) of its samples, their number, and "
                               "frames since the last one",
                               {record_field("key", &Record::key), record_field("mean", &Record::mean),
                                record_field("mean-square", &Record::mean_square),
                                record_field("samples", &Record::samples), record_field("age", &Record::age)},
                               [this] { return grid_.records(); })};
}

std::vector<std::string> CellsPass::warnings() const {
  const HashGridStatistics s = grid_.statistics();
  std::vector<std::string> list;
  if (s.dropped > 0) {
    list.push_back(fmt::format(
        "the cells of {} samples did not fit into an eighth of the machine's memory; these samples were dropped, and "
        "another run may differ in its bits; raise {}.cell-size, or render a smaller image",
        s.dropped, prefix_));
  }
  if (s.discarded > 0) {
    list.push_back(
        fmt::format("{} cells were discarded because the table keeps at most {} slots from frame to frame; raise "
                    "{}.max-cells, or leave it at 0",
                    s.discarded, grid_.limit(), prefix_));
  }
  if (s.nonfinite > 0)
    list.push_back(fmt::format("{} samples for cells were not finite and were ignored", s.nonfinite));
  return list;
}

void CellsPass::save(std::ostream& out) const {
  write_value(out, watched_frames_);
  write_vector(out, grid_.save());
}

void CellsPass::load(std::istream& in) {
  uint32_t watched_frames = 0;
  std::vector<std::byte> bytes;
  read_value(in, watched_frames);
  read_vector(in, bytes);
  grid_.configure(settings_.grid, bounds_for(kMostSlots, 1, physical_memory_bytes()));
  if (!in || !grid_.load(bytes)) return in.setstate(std::ios::failbit);
  watched_frames_ = watched_frames;
  ready_ = true;
}

PassDeclaration ResolveCellsPass::declaration() const {
  const auto layer = [](const BufferId& id, const char* help) {
    return BufferDescription{.id = id, .help = help, .display = BufferDisplay::value};
  };
  PassDeclaration declaration{
      .name = "resolve",
      .stage = Stage::resolve,
      .owns = {layer(kCellIdentity, "identifier of the pixel's cell"),
               layer(kCellLevel, "log2 of the size of the pixel's cell, metres"),
               layer(kCellCount, "number of samples in the pixel's cell"),
               layer(kCellAge, "number of frames with samples since the pixel's cell was created"),
               layer(kCellVariance, "variance of a sample's luminance in the pixel's cell"),
               layer(kCellSurvival, "probability that the pixel's path is followed"),
               layer(kCellBlend, "weight of the cell in the pixel; the rest is the weight of the path"),
               layer(kCellTermination, kCellTerminationHelp),
               layer(kCellOccupancy, "fraction of occupied slots around the pixel's cell")},
      .reads = {kFilteredPixels},
      .writes = {kRadiance, kRays},
      .reads_if_any = {kAllocation}};
  if (cells_.users().history)
    declaration.owns.push_back({.id = kRadianceCells, .help = "part of this frame's sample from cells"});
  return declaration;
}

std::vector<PassStatistic> ResolveCellsPass::statistics() const {
  uint64_t filtered = 0;
  uint64_t culled = 0;
  for (const FilteredPixel& p : pixels_ ? pixels_->read<FilteredPixel>() : View<const FilteredPixel>{}) {
    filtered += p.filtered ? 1 : 0;
    culled += p.culled ? 1 : 0;
  }
  return {{"culled", filtered > 0 ? static_cast<double>(culled) / static_cast<double>(filtered) : 0.0}};
}

BufferDescription filtered_pixels_buffer() {
  return {.id = kFilteredPixels, .help = "vertex and sample of each pixel for its cell"};
}

BufferDescription scatter_chances_buffer() {
  return {.id = kScatterChances, .help = "probability with which the path samples a direction at the primary hit"};
}

BufferDescription cells_at_hit_buffer() {
  return {.id = kCellsAtHit, .help = "1 where cells show the light that the surface reflects"};
}

PassDeclaration cell_paths_declaration(const CellsPass& cells) {
  PassDeclaration declaration{.name = "trace",
                              .stage = Stage::trace,
                              .owns = estimator_buffers(),
                              .reads = {kPrimaryHits},
                              .reads_if_any = {kAllocation},
                              .only_sampled_pixels = true};
  declaration.owns.push_back(filtered_pixels_buffer());
  if (cells.users().history) {
    declaration.owns.push_back(first_vertices_buffer());
    declaration.owns.push_back(cells_at_hit_buffer());
  }
  if (cells.users().reservoirs) {
    declaration.owns.push_back(first_scatters_buffer());
    declaration.owns.push_back(scatter_chances_buffer());
  }
  if (cells.users().indirect) declaration.owns.push_back(indirect_samples_buffer());
  return declaration;
}

bool ResolveCellsPass::run(const FrameContext& frame) {
  cells_.advance(frame);
  ResolveCellsKernel kernel;
  kernel.grid = cells_.filter().grid;
  kernel.pixels = frame.read(kFilteredPixels);
  pixels_ = frame.buffer(kFilteredPixels);
  kernel.radiance = frame.write(kRadiance);
  if (cells_.users().history) kernel.from_cells = frame.write(kRadianceCells);
  kernel.layers = {frame.write(kCellIdentity), frame.write(kCellLevel),       frame.write(kCellCount),
                   frame.write(kCellAge),      frame.write(kCellVariance),    frame.write(kCellSurvival),
                   frame.write(kCellBlend),    frame.write(kCellTermination), frame.write(kCellOccupancy)};
  kernel.width = frame.width();
  kernel.rays = frame.write(kRays);
  kernel.refine = cells_.refine();
  kernel.others = cells_.others();
  kernel.allocation = frame.read(kAllocation);
  kernel.adds = adds_;
  kernel.edges = {.context = make_path_context(source_, frame),
                  .index = frame.index,
                  .pixels = kernel.pixels,
                  .others = kernel.others,
                  .rays = sharpens_edges_ ? cells_.edge_rays() : 0u,
                  .width = frame.width(),
                  .height = frame.height()};
  frame.launch("resolve", kernel);
  cells_.adjust_size(frame.backend);
  return true;
}

}  // namespace relume
