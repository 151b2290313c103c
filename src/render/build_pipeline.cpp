#include "render/build_pipeline.h"

#include <algorithm>

#include "core/error.h"
#include "techniques/accumulate/accumulate_pass.h"
#include "techniques/adaptive_psf/adaptive_psf_pass.h"
#include "techniques/adaptive_sampling/adaptive_sampling_pass.h"
#include "techniques/bdpt/bdpt_pass.h"
#include "techniques/light_selection_pass.h"
#include "techniques/path/path_pass.h"
#include "techniques/path_graphs/path_graphs_pass.h"
#include "techniques/path_space_filter/path_space_filter_pass.h"
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

bool needs_first_vertices(const RenderSettings& settings) {
  return settings.history == HistoryChoice::reproject && settings.reproject.method == ReprojectionMethod::forward;
}

/// The estimator, with the cache that stands in for parts of its paths.
void add_paths(Pipeline& pipeline, const RenderSettings& settings, const PathSource& source) {
  if (settings.estimator != EstimatorChoice::path) {
    const BdptMode mode = settings.estimator == EstimatorChoice::light ? BdptMode::light_only : BdptMode::bidirectional;
    add<BdptPass>(pipeline, mode, settings.bdpt, settings.path, source.selector, source.directions);
    return;
  }
  if (settings.cache == CacheChoice::none) {
    add<PathPass>(pipeline, source, needs_first_vertices(settings));
    return;
  }
  const bool every_vertex = settings.cache == CacheChoice::apg || settings.cache == CacheChoice::apsf_apg;
  CellsPass& cells = add<CellsPass>(pipeline, settings.psf, every_vertex ? kGraphDepths : 1u);
  switch (settings.cache) {
    case CacheChoice::none: break;
    case CacheChoice::psf: add<PathSpaceFilterPass>(pipeline, source, cells); break;
    case CacheChoice::apsf: add<AdaptivePsfPass>(pipeline, settings.apsf, source, cells); break;
    case CacheChoice::apg: add<PathGraphPass>(pipeline, settings.apg, nullptr, source, cells); break;
    case CacheChoice::apsf_apg: add<PathGraphPass>(pipeline, settings.apg, &settings.apsf, source, cells); break;
  }
  add<ResolveCellsPass>(pipeline, cells);
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

}  // namespace

void check_combination(const RenderSettings& settings) {
  if (settings.cache == CacheChoice::apsf || settings.cache == CacheChoice::apsf_apg) check(settings.apsf);
  if (settings.allocation == AllocationChoice::adaptive && settings.history == HistoryChoice::none) {
    throw Error(
        "allocation 'adaptive' does not combine with history 'none': pixels without a sample in a frame would have "
        "nothing to show; use history 'accumulate' or 'reproject'");
  }
  const bool from_both_ends = settings.estimator != EstimatorChoice::path;
  if (from_both_ends && settings.cache != CacheChoice::none) {
    throw Error(
        "estimators 'bdpt' and 'light' do not combine with a radiance cache: what light paths bring to a pixel has no "
        "cell; use estimator 'path' or cache 'none'");
  }
  if (from_both_ends && needs_first_vertices(settings)) {
    throw Error(
        "estimators 'bdpt' and 'light' do not combine with history 'reproject' by reproject.method 'forward', which "
        "judges the directions of one path; use reproject.method 'backward' or history 'accumulate'");
  }
  if (settings.cache != CacheChoice::none && needs_first_vertices(settings)) {
    throw Error(
        "a radiance cache does not combine with history 'reproject' by reproject.method 'forward', which needs "
        "paths of the pixel's own; use reproject.method 'backward' or history 'accumulate'");
  }
}

Pipeline build_pipeline(const RenderSettings& settings) {
  check_combination(settings);
  static const DirectionSampler bsdf_directions;
  Pipeline pipeline;
  const LightSelector& selector = add_light_selection(pipeline, settings);
  add<PrimaryHitsPass>(pipeline);
  add_paths(pipeline, settings, {settings.path, selector, bsdf_directions});
  add_history(pipeline, settings);
  add_allocation(pipeline, settings);
  if (settings.auxiliary) add<AuxiliaryPass>(pipeline);
  if (reads_surface(pipeline)) add<SurfacePass>(pipeline);
  pipeline.check();
  return pipeline;
}

}  // namespace relume
