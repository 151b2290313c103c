#include "render/build_pipeline.h"

#include <algorithm>

#include "techniques/accumulate/accumulate_pass.h"
#include "techniques/light_selection_pass.h"
#include "techniques/path/path_pass.h"
#include "techniques/primary_hits/primary_hits_pass.h"

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

void add_history(Pipeline& pipeline, const RenderSettings& settings) {
  switch (settings.history) {
    case HistoryChoice::none: add<AccumulatePass>(pipeline, Change::any, false); break;
    case HistoryChoice::accumulate: add<AccumulatePass>(pipeline, Change::any, true); break;
  }
}

}  // namespace

void check_combination(const RenderSettings&) {}

Pipeline build_pipeline(const RenderSettings& settings) {
  check_combination(settings);
  Pipeline pipeline;
  static const DirectionSampler bsdf_directions;
  const LightSelector& selector = add_light_selection(pipeline, settings);
  add<PrimaryHitsPass>(pipeline);
  add<PathPass>(pipeline, settings.path, selector, bsdf_directions);
  add_history(pipeline, settings);
  if (settings.auxiliary) add<AuxiliaryPass>(pipeline);
  if (reads_surface(pipeline)) add<SurfacePass>(pipeline);
  pipeline.check();
  return pipeline;
}

}  // namespace relume
