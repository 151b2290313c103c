#include "render/build_pipeline.h"

#include <algorithm>

#include "core/error.h"
#include "techniques/accumulate/accumulate_pass.h"
#include "techniques/adaptive_sampling/adaptive_sampling_pass.h"
#include "techniques/light_selection_pass.h"
#include "techniques/path/path_pass.h"
#include "techniques/primary_hits/primary_hits_pass.h"
#include "techniques/reprojection/reprojection_pass.h"

namespace relume {
namespace {

/// Adds the pass and hands it back, for the passes that read what it makes.
template <typename P, typename... Arguments>
P& add(Pipeline& pipeline, Arguments&&... arguments) {
  auto pass = std::make_unique<P>(std::forward<Arguments>(arguments)...);
  P& added = *pass;
  pipeline.add(std::move(pass));
  return added;
}

bool reads_surface(const Pipeline& pipeline) {
  const std::vector<PassDeclaration> list = pipeline.declarations();
  return std::any_of(list.begin(), list.end(), [](const PassDeclaration& pass) {
    return std::any_of(pass.reads.begin(), pass.reads.end(),
                       [](std::string_view buffer) { return buffer.starts_with("surface-"); });
  });
}

const LightSelector& add_light_selection(Pipeline& pipeline, const RenderSettings& settings) {
  return add<LightSelectionPass>(pipeline, static_cast<LightSelectorKind>(settings.lights)).selector();
}

/// Changes that the history does not survive.
Change ends_history(const RenderSettings& settings) {
  return settings.history == HistoryChoice::reproject ? Change::materials | Change::settings : Change::any;
}

uint32_t pixel_count(const RenderSettings& settings) {
  return static_cast<uint32_t>(settings.width) * static_cast<uint32_t>(settings.height);
}

void add_history(Pipeline& pipeline, const RenderSettings& settings) {
  add<AccumulatePass>(pipeline, ends_history(settings), settings.history != HistoryChoice::none);
  if (settings.history != HistoryChoice::reproject) return;
  auto& reprojection = add<ReprojectionPass>(pipeline, settings.reproject, pixel_count(settings));
  if (settings.reproject.method == ReprojectionMethod::forward)
    add<StoreSamplesPass>(pipeline, settings.reproject, reprojection);
}

void add_allocation(Pipeline& pipeline, const RenderSettings& settings) {
  if (settings.allocation == AllocationChoice::adaptive)
    add<AdaptiveSamplingPass>(pipeline, settings.adaptive, ends_history(settings));
}

bool needs_first_vertices(const RenderSettings& settings) {
  return settings.history == HistoryChoice::reproject && settings.reproject.method == ReprojectionMethod::forward;
}

}  // namespace

void check_combination(const RenderSettings& settings) {
  if (settings.allocation == AllocationChoice::adaptive && settings.history == HistoryChoice::none) {
    throw Error(
        "allocation 'adaptive' does not combine with history 'none': pixels without a sample in a frame would have "
        "nothing to show; use history 'accumulate' or 'reproject'");
  }
}

Pipeline build_pipeline(const RenderSettings& settings) {
  check_combination(settings);
  Pipeline pipeline;
  static const DirectionSampler bsdf_directions;
  const LightSelector& selector = add_light_selection(pipeline, settings);
  add<PrimaryHitsPass>(pipeline);
  add<PathPass>(pipeline, settings.path, selector, bsdf_directions, needs_first_vertices(settings));
  add_history(pipeline, settings);
  add_allocation(pipeline, settings);
  if (settings.auxiliary) add<AuxiliaryPass>(pipeline);
  if (reads_surface(pipeline)) add<SurfacePass>(pipeline);
  pipeline.check();
  return pipeline;
}

}  // namespace relume
