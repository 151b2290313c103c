#include "techniques/reuse/restir_di/restir_pass.h"

#include "techniques/reuse/reservoir/ris_pass.h"
#include "techniques/reuse/restir_di/spatial_reuse.h"
#include "techniques/reuse/restir_di/temporal_reuse.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<LightReservoir> kReservoirs{"restir-reservoirs"};
constexpr BufferKey<LightReservoir> kReservoirHistory{"restir-history"};
constexpr BufferKey<ReceiverRecord> kReceivers{"restir-receivers"};

/// Changes after which reservoirs of the previous frame are not reused. Lights may move: their previous state is known,
/// except that of the environment.
Change ends_reservoirs(const RestirSettings& settings) {
  const Change always = Change::materials | Change::settings | Change::light_list;
  return settings.correction == ReuseCorrection::exact ? always | Change::geometry : always;
}

bool is_traced(const RestirSettings& settings) { return settings.correction != ReuseCorrection::basic; }

}  // namespace

PassDeclaration RestirPass::declaration() const {
  PassDeclaration declaration{
      .name = "restir-di",
      .stage = Stage::resolve,
      .owns = {{.id = kReservoirs, .help = "reservoirs before the reuse of neighbouring pixels"},
               {.id = kReservoirHistory,
                .help = "reservoirs that the next frame reuses",
                .persistent = true,
                .double_buffered = true,
                .reset = ends_reservoirs(settings_)},
               {.id = kReceivers,
                .help = "primary hits as receivers of direct light",
                .persistent = true,
                .double_buffered = true,
                .reset = ends_reservoirs(settings_)}},
      .reads = reservoir_reads(),
      .writes = reservoir_writes(),
      .writes_if_any = reservoir_writes_if_any()};
  for (const BufferId& id : {BufferId(kSurface.motion), BufferId(kSurface.previous), BufferId(kSurface.position),
                             BufferId(kSurface.normal), BufferId(kSurface.depth), BufferId(kSurface.surface)})
    declaration.reads.push_back(id);
  return declaration;
}

bool RestirPass::run(const FrameContext& frame) {
  TemporalReuseKernel temporal;
  temporal.stage = candidate_stage(candidates_, source_, recording_, frame);
  temporal.reprojection = backward_reprojection(frame, kSurface);
  temporal.history = frame.previous(kReservoirHistory);
  temporal.history_records = frame.previous(kReceivers);
  temporal.reservoirs = frame.write(kReservoirs);
  temporal.records = frame.write(kReceivers);
  temporal.image = reservoir_image(frame);
  temporal.previous_camera = frame.scene.previous_camera;
  temporal.cap = static_cast<float>(settings_.cap);
  temporal.traced = is_traced(settings_);
  temporal.moved = includes(frame.changes, Change::geometry);
  if (!frame.launch_or_stop("restir-temporal", temporal)) return false;

  SpatialReuseKernel spatial;
  spatial.scene = frame.scene;
  spatial.reservoirs = frame.read(kReservoirs);
  spatial.records = frame.read(kReceivers);
  spatial.search = {.normal = frame.read(kSurface.normal),
                    .depth = frame.read(kSurface.depth),
                    .count = static_cast<uint32_t>(settings_.neighbours),
                    .radius = settings_.radius,
                    .width = frame.width(),
                    .height = frame.height()};
  spatial.history = frame.write(kReservoirHistory);
  spatial.image = reservoir_image(frame);
  spatial.seed = frame.index.seed;
  spatial.frame = frame.index.frame;
  spatial.traced = is_traced(settings_);
  spatial.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-spatial", spatial);
}

}  // namespace relume
