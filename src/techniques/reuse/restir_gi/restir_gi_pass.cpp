#include "techniques/reuse/restir_gi/restir_gi_pass.h"

#include "techniques/reuse/restir_gi/indirect_spatial.h"
#include "techniques/reuse/restir_gi/indirect_temporal.h"
#include "techniques/reuse/restir_gi/indirect_validation.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<IndirectReservoir> kIndirectReservoirs{"restir-gi-reservoirs"};
constexpr BufferKey<IndirectReservoir> kIndirectHistory{"restir-gi-history"};
constexpr BufferKey<ReceiverRecord> kIndirectReceivers{"restir-gi-receivers"};
constexpr BufferKey<Rgb> kValidatedRadiance{"restir-gi-validated"};

/// Changes after which reservoirs of the previous frame are not reused. The radiance of their samples depends on all
/// lights and surfaces.
Change ends_reservoirs(const RestirGiSettings& settings) {
  const Change always = Change::materials | Change::settings | Change::light_list;
  if (settings.correction != ReuseCorrection::exact) return always;
  return always | Change::geometry | Change::lights;
}

bool is_traced(const RestirGiSettings& settings) { return settings.correction != ReuseCorrection::basic; }

ReconnectionRule rule_of(const RestirGiSettings& settings) {
  return {.least_alpha = sqr(settings.roughness),
          .reuses_glossy = settings.reuse_glossy,
          .largest_jacobian = settings.jacobian};
}

IndirectImage image_of(const FrameContext& frame) {
  return {frame.write(kRadiance), frame.write(kRadianceSpecular), frame.write(kRays)};
}

}  // namespace

bool RestirGiPass::validates() const {
  return repeats_ && settings_.validate > 0 && settings_.cap > 0 && settings_.correction != ReuseCorrection::exact;
}

PassDeclaration RestirGiPass::declaration() const {
  PassDeclaration declaration{
      .name = "restir-gi",
      .stage = Stage::resolve,
      .owns = {{.id = kIndirectReservoirs, .help = "reservoirs of indirect light before the reuse of neighbours"},
               {.id = kIndirectHistory,
                .help = "reservoirs of indirect light that the next frame reuses",
                .persistent = true,
                .double_buffered = true,
                .reset = ends_reservoirs(settings_)},
               {.id = kIndirectReceivers,
                .help = "primary hits as receivers of indirect light",
                .persistent = true,
                .double_buffered = true,
                .reset = ends_reservoirs(settings_)}},
      .reads = {kPrimaryHits, kIndirectSamples},
      .writes = {kRadiance, kRays},
      .writes_if_any = {kRadianceSpecular}};
  for (const BufferId& id : {BufferId(kSurface.motion), BufferId(kSurface.previous), BufferId(kSurface.position),
                             BufferId(kSurface.normal), BufferId(kSurface.depth), BufferId(kSurface.surface)})
    declaration.reads.push_back(id);
  if (validates()) {
    declaration.owns.push_back(
        {.id = kValidatedRadiance, .help = "radiance of the previous frame's samples in this frame"});
  }
  return declaration;
}

bool RestirGiPass::run(const FrameContext& frame) {
  return (!validates() || validate(frame)) && reuse_history(frame) && reuse_neighbours(frame);
}

bool RestirGiPass::validate(const FrameContext& frame) const {
  IndirectValidationKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.index = frame.index;
  kernel.rule = rule_of(settings_);
  kernel.history = frame.previous(kIndirectHistory);
  kernel.records = frame.previous(kIndirectReceivers);
  kernel.radiance = frame.write(kValidatedRadiance);
  kernel.rays = frame.write(kRays);
  kernel.interval = static_cast<uint32_t>(settings_.validate);
  kernel.width = frame.width();
  return frame.launch_or_stop("restir-gi-validate", kernel);
}

bool RestirGiPass::reuse_history(const FrameContext& frame) const {
  IndirectTemporalKernel kernel;
  kernel.scene = frame.scene;
  kernel.index = frame.index;
  kernel.rule = rule_of(settings_);
  kernel.hits = frame.read(kPrimaryHits);
  kernel.samples = frame.read(kIndirectSamples);
  kernel.reprojection = backward_reprojection(frame, kSurface);
  kernel.history = frame.previous(kIndirectHistory);
  kernel.history_records = frame.previous(kIndirectReceivers);
  if (validates()) kernel.validated = frame.read(kValidatedRadiance);
  kernel.reservoirs = frame.write(kIndirectReservoirs);
  kernel.records = frame.write(kIndirectReceivers);
  kernel.image = image_of(frame);
  kernel.max_bounces = static_cast<uint32_t>(source_.settings.max_bounces);
  kernel.cap = static_cast<float>(settings_.cap);
  kernel.traced = is_traced(settings_);
  kernel.moved = includes(frame.changes, Change::geometry);
  kernel.width = frame.width();
  return frame.launch_or_stop("restir-gi-temporal", kernel);
}

bool RestirGiPass::reuse_neighbours(const FrameContext& frame) const {
  IndirectSpatialKernel kernel;
  kernel.scene = frame.scene;
  kernel.rule = rule_of(settings_);
  kernel.search = {.normal = frame.read(kSurface.normal),
                   .depth = frame.read(kSurface.depth),
                   .count = static_cast<uint32_t>(settings_.neighbours),
                   .radius = settings_.radius,
                   .width = frame.width(),
                   .height = frame.height()};
  kernel.reservoirs = frame.read(kIndirectReservoirs);
  kernel.records = frame.read(kIndirectReceivers);
  kernel.history = frame.write(kIndirectHistory);
  kernel.image = image_of(frame);
  kernel.seed = frame.index.seed;
  kernel.frame = frame.index.frame;
  kernel.traced = is_traced(settings_);
  kernel.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-gi-spatial", kernel);
}

}  // namespace relume
