#include "techniques/reuse/restir_pt/restir_pt_pass.h"

#include <array>

#include "techniques/reuse/restir_pt/path_candidates.h"
#include "techniques/reuse/restir_pt/path_duplicates.h"
#include "techniques/reuse/restir_pt/path_pairs.h"
#include "techniques/reuse/restir_pt/path_spatial.h"
#include "techniques/reuse/restir_pt/path_temporal.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<PathReservoir> kPathReservoirs{"restir-pt-reservoirs"};
constexpr BufferKey<PathReservoir> kPathHistory{"restir-pt-history"};
constexpr BufferKey<ReceiverRecord> kPathReceivers{"restir-pt-receivers"};
constexpr BufferKey<uint32_t> kPathDuplicates{"restir-pt-duplicates"};
/// By number of the pair.
constexpr std::array<BufferKey<PairedPath>, kMostReuseNeighbours> kPairedPaths{{{"restir-pt-pair-1"},
                                                                                {"restir-pt-pair-2"},
                                                                                {"restir-pt-pair-3"},
                                                                                {"restir-pt-pair-4"},
                                                                                {"restir-pt-pair-5"},
                                                                                {"restir-pt-pair-6"},
                                                                                {"restir-pt-pair-7"},
                                                                                {"restir-pt-pair-8"}}};

/// Changes after which reservoirs of the previous frame are not reused. The light of their paths depends on all lights
/// and surfaces.
Change ends_reservoirs(const RestirPtSettings& settings) {
  const Change always = Change::materials | Change::settings | Change::light_list;
  if (settings.correction != PathCorrection::exact) return always;
  return always | Change::geometry | Change::lights;
}

ConnectRule rule_of(const RestirPtSettings& settings) {
  return {.shift = settings.shift,
          .kind = settings.connect,
          .least_alpha = sqr(settings.roughness),
          .least_distance = settings.distance,
          .least_footprint = settings.footprint};
}

bool has_cones(const RestirPtSettings& settings) { return settings.textures == PathTextures::cones; }

PathImage image_of(const FrameContext& frame) {
  return {frame.write(kRadiance), frame.write(kRadianceSpecular), frame.write(kRays)};
}

}  // namespace

PassDeclaration RestirPtPass::declaration() const {
  PassDeclaration declaration{
      .name = "restir-pt",
      .stage = Stage::resolve,
      .owns = {{.id = kPathReservoirs, .help = "reservoirs of paths before the reuse of neighbours"},
               {.id = kPathHistory,
                .help = "reservoirs of paths that the next frame reuses",
                .persistent = true,
                .double_buffered = true,
                .reset = ends_reservoirs(settings_)},
               {.id = kPathReceivers,
                .help = "primary hits to which paths are shifted",
                .persistent = true,
                .double_buffered = true,
                .reset = ends_reservoirs(settings_)}},
      .reads = {kPrimaryHits},
      .writes = {kRadiance, kRays},
      .writes_if_any = {kRadianceSpecular}};
  for (const BufferId& id : {BufferId(kSurface.motion), BufferId(kSurface.previous), BufferId(kSurface.position),
                             BufferId(kSurface.normal), BufferId(kSurface.depth), BufferId(kSurface.surface)})
    declaration.reads.push_back(id);
  if (finds_duplicates()) {
    declaration.owns.push_back(
        {.id = kPathDuplicates, .help = "number of pixels around each one that had the same path"});
  }
  for (size_t i = 0; settings_.reciprocal && i < static_cast<size_t>(settings_.neighbours); ++i)
    declaration.owns.push_back({.id = kPairedPaths[i], .help = "path of the other pixel of a pair at this pixel"});
  return declaration;
}

bool RestirPtPass::run(const FrameContext& frame) {
  return trace_candidates(frame) && count_duplicates(frame) && reuse_history(frame) && shift_pairs(frame) &&
         reuse_neighbours(frame);
}

PathShifter RestirPtPass::shifter(const FrameContext& frame) const {
  return {.context = make_path_context(source_, frame),
          .rule = rule_of(settings_),
          .index = frame.index,
          .width = frame.width(),
          .has_cones = has_cones(settings_)};
}

bool RestirPtPass::trace_candidates(const FrameContext& frame) const {
  PathCandidateKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.rule = rule_of(settings_);
  kernel.index = frame.index;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.reservoirs = frame.write(kPathReservoirs);
  kernel.records = frame.write(kPathReceivers);
  kernel.image = image_of(frame);
  kernel.width = frame.width();
  kernel.has_cones = has_cones(settings_);
  return frame.launch_or_stop("restir-pt-trace", kernel);
}

bool RestirPtPass::count_duplicates(const FrameContext& frame) const {
  if (!finds_duplicates()) return true;
  PathDuplicatesKernel kernel;
  kernel.history = frame.previous(kPathHistory);
  kernel.duplicates = frame.write(kPathDuplicates);
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("restir-pt-duplicates", kernel);
}

bool RestirPtPass::reuse_history(const FrameContext& frame) const {
  if (settings_.cap == 0) return true;
  PathTemporalKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.reprojection = backward_reprojection(frame, kSurface);
  kernel.history = frame.previous(kPathHistory);
  kernel.history_records = frame.previous(kPathReceivers);
  kernel.records = frame.read(kPathReceivers);
  kernel.reservoirs = frame.write(kPathReservoirs);
  kernel.rays = frame.write(kRays);
  kernel.correction = settings_.correction;
  if (finds_duplicates()) kernel.duplicates = frame.read(kPathDuplicates);
  kernel.cap = DuplicateCap::of(static_cast<float>(settings_.cap), settings_.duplication);
  kernel.moved = includes(frame.changes, Change::geometry);
  return frame.launch_or_stop("restir-pt-temporal", kernel);
}

PairSearch RestirPtPass::pairs(const FrameContext& frame) const {
  return {.search = {.normal = frame.read(kSurface.normal),
                     .depth = frame.read(kSurface.depth),
                     .count = static_cast<uint32_t>(settings_.neighbours),
                     .radius = settings_.radius,
                     .width = frame.width(),
                     .height = frame.height()},
          .seed = frame.index.seed,
          .frame = frame.index.frame,
          .edge = pair_tile_edge(settings_.radius)};
}

bool RestirPtPass::shift_pairs(const FrameContext& frame) const {
  if (!settings_.reciprocal) return true;
  PathPairKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.pairs = pairs(frame);
  kernel.reservoirs = frame.read(kPathReservoirs);
  kernel.records = frame.read(kPathReceivers);
  for (uint32_t i = 0; i < kernel.pairs.search.count; ++i) kernel.paths[i] = frame.write(kPairedPaths[i]);
  kernel.rays = frame.write(kRays);
  return frame.launch_or_stop("restir-pt-pairs", kernel);
}

bool RestirPtPass::reuse_neighbours(const FrameContext& frame) const {
  PathSpatialKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.pairs = pairs(frame);
  if (settings_.reciprocal) {
    for (uint32_t i = 0; i < kernel.pairs.search.count; ++i) kernel.paired[i] = frame.read(kPairedPaths[i]);
  }
  kernel.reciprocal = settings_.reciprocal;
  kernel.reservoirs = frame.read(kPathReservoirs);
  kernel.records = frame.read(kPathReceivers);
  kernel.history = frame.write(kPathHistory);
  kernel.image = image_of(frame);
  kernel.correction = settings_.correction;
  kernel.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-pt-spatial", kernel);
}

}  // namespace relume
