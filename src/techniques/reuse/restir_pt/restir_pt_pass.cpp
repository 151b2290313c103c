#include "techniques/reuse/restir_pt/restir_pt_pass.h"

#include "techniques/reuse/restir_pt/path_candidates.h"
#include "techniques/reuse/restir_pt/path_spatial.h"
#include "techniques/reuse/restir_pt/path_temporal.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<PathReservoir> kPathReservoirs{"restir-pt-reservoirs"};
constexpr BufferKey<PathReservoir> kPathHistory{"restir-pt-history"};
constexpr BufferKey<ReceiverRecord> kPathReceivers{"restir-pt-receivers"};

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
  return declaration;
}

bool RestirPtPass::run(const FrameContext& frame) {
  return trace_candidates(frame) && reuse_history(frame) && reuse_neighbours(frame);
}

PathShifter RestirPtPass::shifter(const FrameContext& frame) const {
  return {.context = make_path_context(source_, frame),
          .rule = rule_of(settings_),
          .index = frame.index,
          .width = frame.width()};
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
  return frame.launch_or_stop("restir-pt-trace", kernel);
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
  kernel.cap = static_cast<float>(settings_.cap);
  kernel.moved = includes(frame.changes, Change::geometry);
  return frame.launch_or_stop("restir-pt-temporal", kernel);
}

bool RestirPtPass::reuse_neighbours(const FrameContext& frame) const {
  PathSpatialKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.search = {.normal = frame.read(kSurface.normal),
                   .depth = frame.read(kSurface.depth),
                   .count = static_cast<uint32_t>(settings_.neighbours),
                   .radius = settings_.radius,
                   .width = frame.width(),
                   .height = frame.height()};
  kernel.reservoirs = frame.read(kPathReservoirs);
  kernel.records = frame.read(kPathReceivers);
  kernel.history = frame.write(kPathHistory);
  kernel.image = image_of(frame);
  kernel.correction = settings_.correction;
  kernel.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-pt-spatial", kernel);
}

}  // namespace relume
