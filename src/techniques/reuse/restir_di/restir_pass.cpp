#include "techniques/reuse/restir_di/restir_pass.h"

#include "techniques/reuse/reservoir/reuse_pass.h"
#include "techniques/reuse/reservoir/ris_pass.h"
#include "techniques/reuse/restir_di/spatial_reuse.h"
#include "techniques/reuse/restir_di/temporal_reuse.h"

namespace relume {
namespace {

constexpr ReuseBuffers<LightPoint> kDirect{
    {"restir-reservoirs"}, {"restir-history"}, {"restir-receivers"}, "direct light"};

/// Changes after which reservoirs of the previous frame are not reused. Lights may move: their previous state is known,
/// except that of the environment.
Change ends_reservoirs(const RestirSettings& settings) {
  const bool exact = settings.correction == ReuseCorrection::exact;
  return exact ? kEndsReservoirs | Change::geometry : kEndsReservoirs;
}

bool is_traced(const RestirSettings& settings) { return settings.correction != ReuseCorrection::basic; }

}  // namespace

PassDeclaration RestirPass::declaration() const {
  PassDeclaration declaration{.name = "restir-di",
                              .stage = Stage::resolve,
                              .owns = reuse_descriptions(kDirect, ends_reservoirs(settings_)),
                              .reads = reservoir_reads(),
                              .writes = reservoir_writes(),
                              .reads_if_any = reservoir_reads_if_any(),
                              .writes_if_any = reservoir_writes_if_any()};
  read_surfaces(declaration);
  return declaration;
}

bool RestirPass::run(const FrameContext& frame) {
  TemporalReuseKernel temporal;
  temporal.stage = candidate_stage(candidates_, source_, records_, paths_, frame);
  temporal.history = reservoir_history(frame, kDirect, settings_.cap);
  temporal.reservoirs = frame.write(kDirect.reservoirs);
  temporal.records = frame.write(kDirect.receivers);
  temporal.image = reservoir_image(frame);
  temporal.previous_camera = frame.scene.previous_camera;
  temporal.traced = is_traced(settings_);
  if (!frame.launch_or_stop("restir-temporal", temporal)) return false;

  SpatialReuseKernel spatial;
  spatial.scene = frame.scene;
  spatial.reservoirs = frame.read(kDirect.reservoirs);
  spatial.records = frame.read(kDirect.receivers);
  spatial.search = neighbour_search(frame, settings_.neighbours, settings_.radius);
  spatial.history = frame.write(kDirect.history);
  spatial.image = reservoir_image(frame);
  spatial.seed = frame.index.seed;
  spatial.frame = frame.index.frame;
  spatial.traced = is_traced(settings_);
  spatial.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-spatial", spatial);
}

}  // namespace relume
