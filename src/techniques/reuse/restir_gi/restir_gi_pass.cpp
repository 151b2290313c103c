#include "techniques/reuse/restir_gi/restir_gi_pass.h"

#include "techniques/reuse/reservoir/reuse_pass.h"
#include "techniques/reuse/restir_gi/indirect_spatial.h"
#include "techniques/reuse/restir_gi/indirect_temporal.h"
#include "techniques/reuse/restir_gi/indirect_validation.h"
#include "techniques/transport/path/frame_wavelength.h"

namespace relume {
namespace {

constexpr ReuseBuffers<IndirectVertex> kIndirect{
    {"restir-gi-reservoirs"}, {"restir-gi-history"}, {"restir-gi-receivers"}, "indirect light"};
constexpr BufferKey<Rgb> kValidatedRadiance{"restir-gi-validated"};

/// Changes after which reservoirs of the previous frame are not reused. The radiance of their samples depends on all
/// lights and surfaces.
Change ends_reservoirs(const RestirGiSettings& settings) {
  const bool exact = settings.correction == ReuseCorrection::exact;
  return exact ? kEndsReservoirs | Change::geometry | Change::lights : kEndsReservoirs;
}

bool is_traced(const RestirGiSettings& settings) { return settings.correction != ReuseCorrection::basic; }

IndirectImage indirect_image(const FrameContext& frame) { return {reuse_image(frame), frame.write(kFirstVertices)}; }

ReconnectionRule rule_of(const RestirGiSettings& settings) {
  return {.least_alpha = sqr(settings.roughness),
          .reuses_glossy = settings.reuse_glossy,
          .largest_jacobian = settings.jacobian};
}

}  // namespace

bool RestirGiPass::validates() const {
  return repeats_ && settings_.validate > 0 && settings_.cap > 0 && settings_.correction != ReuseCorrection::exact;
}

PassDeclaration RestirGiPass::declaration() const {
  PassDeclaration declaration{.name = "restir-gi",
                              .stage = Stage::resolve,
                              .owns = reuse_descriptions(kIndirect, ends_reservoirs(settings_)),
                              .reads = {kPrimaryHits, kIndirectSamples},
                              .writes = {kRadiance, kRays},
                              .reads_if_any = {kAllocation},
                              .writes_if_any = {kRadianceSpecular, kFirstVertices}};
  read_surfaces(declaration);
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
  kernel.history = frame.previous(kIndirect.history);
  kernel.records = frame.previous(kIndirect.receivers);
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
  kernel.history = reservoir_history(frame, kIndirect, settings_.cap);
  if (validates()) kernel.validated = frame.read(kValidatedRadiance);
  kernel.reservoirs = frame.write(kIndirect.reservoirs);
  kernel.records = frame.write(kIndirect.receivers);
  kernel.image = indirect_image(frame);
  kernel.max_bounces = static_cast<uint32_t>(source_.settings.max_bounces);
  kernel.traced = is_traced(settings_);
  kernel.width = frame.width();
  if (paths_ == CandidatePaths::one_wavelength_subpaths && frame.scene.disperses)
    kernel.wavelength_nm = frame_wavelength(frame.index);
  return frame.launch_or_stop("restir-gi-temporal", kernel);
}

bool RestirGiPass::reuse_neighbours(const FrameContext& frame) const {
  IndirectSpatialKernel kernel;
  kernel.scene = frame.scene;
  kernel.rule = rule_of(settings_);
  kernel.search = neighbour_search(frame, settings_.neighbours, settings_.radius);
  kernel.reservoirs = frame.read(kIndirect.reservoirs);
  kernel.records = frame.read(kIndirect.receivers);
  kernel.history = frame.write(kIndirect.history);
  kernel.image = indirect_image(frame);
  kernel.seed = frame.index.seed;
  kernel.frame = frame.index.frame;
  kernel.traced = is_traced(settings_);
  kernel.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-gi-spatial", kernel);
}

}  // namespace relume
