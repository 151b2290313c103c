#include "render/estimator_passes.h"

#include <utility>

#include "techniques/light_sampling/light_tree/light_tree_pass.h"
#include "techniques/radiance_cache/adaptive_psf/adaptive_psf_pass.h"
#include "techniques/radiance_cache/adaptive_psf/subpath_cells_pass.h"
#include "techniques/radiance_cache/path_graphs/path_graphs_pass.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter_pass.h"
#include "techniques/radiance_cache/sharc/sharc_pass.h"
#include "techniques/reuse/reservoir/ris_pass.h"
#include "techniques/reuse/restir_di/restir_pass.h"
#include "techniques/reuse/restir_gi/restir_gi_pass.h"
#include "techniques/reuse/restir_pt/cached_restir_pt_pass.h"
#include "techniques/transport/bdpt/bdpt_pass.h"
#include "techniques/transport/vcm/vcm_pass.h"

namespace relume {
namespace {

/// Whether diffuse and specular light are separated. Only path tracing without a radiance cache can separate them.
bool can_split(const RenderSettings& settings) {
  return settings.features.split && settings.estimator == EstimatorChoice::path && settings.cache == CacheChoice::none;
}

/// The paths whose directions reservoirs take as candidates.
CandidatePaths candidate_paths(EstimatorChoice estimator) {
  switch (estimator) {
    case EstimatorChoice::path: break;
    case EstimatorChoice::bdpt:
    case EstimatorChoice::light: return CandidatePaths::subpaths;
    case EstimatorChoice::vcm: return CandidatePaths::one_wavelength_subpaths;
  }
  return CandidatePaths::traced_paths;
}

/// Whether paths of reservoir samples read cells, whose content changes every frame.
bool samples_end_in_cells(CacheChoice cache) {
  return cache == CacheChoice::apg || cache == CacheChoice::apsf_apg || cache == CacheChoice::sharc;
}

/// Whether light selection learns from paths.
bool learns_lights(LightSelectionChoice lights) {
  return lights == LightSelectionChoice::vlc || lights == LightSelectionChoice::neeat ||
         lights == LightSelectionChoice::mcls;
}

/// Adds reservoirs of paths. Shifts only repeat choices that do not learn: BSDF sampling, and a light tree in place of
/// light selection that learns. `cells`: those of the cache; nullptr: none.
void add_path_reservoirs(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                         const LearningRecords& learning, const CellsPass* cells) {
  static const DirectionSampler bsdf_directions;
  const bool guides = settings.guide != GuideChoice::bsdf;
  const bool selects = learns_lights(settings.lights);
  const LightSelector& selector =
      selects ? builder.add<LightTreePass, &RenderSettings::light_selection>().selector() : source.selector;
  const PathSource fixed{source.settings, selector, bsdf_directions};
  const PathLearning learned{.selector = selects ? &source.selector : nullptr,
                             .directions = guides ? &source.directions : nullptr,
                             .samples = learning.samples,
                             .chains = learning.chains};
  switch (settings.cache) {
    case CacheChoice::sharc:
      builder.add_tracing<SharcRestirPtPass, &RenderSettings::restir_pt, &RenderSettings::sharc>(fixed, learned,
                                                                                                 *cells);
      break;
    case CacheChoice::apg:
    case CacheChoice::apsf_apg:
      builder.add_tracing<GraphRestirPtPass, &RenderSettings::restir_pt, &RenderSettings::apg>(fixed, learned, *cells);
      break;
    case CacheChoice::none:
    case CacheChoice::psf:
    case CacheChoice::apsf: builder.add_tracing<RestirPtPass, &RenderSettings::restir_pt>(fixed, learned); break;
  }
}

/// Adds the reservoirs at primary hits. `cells`: those of the cache, if any.
void add_reuse(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
               const LearningRecords& learning, const CellsPass* cells = nullptr) {
  const CandidateRecords records{learning.samples, learning.chains.lights};
  const CandidatePaths paths = candidate_paths(settings.estimator);
  const auto add_direct = [&] {
    builder.add_tracing<RestirPass, &RenderSettings::ris, &RenderSettings::restir>(source, records, paths);
  };
  const auto add_indirect = [&] {
    const bool has_light_paths = settings.estimator != EstimatorChoice::path;
    const bool repeats = !learns(settings) && !samples_end_in_cells(settings.cache) && !has_light_paths;
    builder.add_tracing<RestirGiPass, &RenderSettings::restir_gi>(source, paths, repeats);
  };
  switch (settings.reuse) {
    case ReuseChoice::none: break;
    case ReuseChoice::ris: builder.add_tracing<RisPass, &RenderSettings::ris>(source, records, paths); break;
    case ReuseChoice::restir_di: add_direct(); break;
    case ReuseChoice::restir_gi: add_indirect(); break;
    case ReuseChoice::restir_di_gi:
      add_direct();
      add_indirect();
      break;
    case ReuseChoice::restir_pt: add_path_reservoirs(builder, settings, source, learning, cells); break;
  }
}

/// Adds path tracing with the spatially hashed radiance cache. Its cells lie behind primary hits, whose light
/// reservoirs can add.
void add_sharc(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
               const LearningRecords& learning) {
  const CellPathUsers users{.history = needs_first_vertices(settings),
                            .reservoirs = resamples_direct_light(settings.reuse),
                            .indirect = resamples_indirect_light(settings.reuse),
                            .whole_paths = settings.reuse == ReuseChoice::restir_pt};
  auto& cells =
      builder.add<CellsPass>(cell_settings(settings.sharc), cell_depths(settings.sharc).count, users, "sharc");
  builder.add_follower(cells, [](const RenderSettings& s) { return cell_settings(s.sharc); });
  builder.add_follower(cells, [](const RenderSettings& s) { return cell_depths(s.sharc); });
  builder.add_tracing<SharcPass, &RenderSettings::sharc>(source, cells, learning);
  add_reuse(builder, settings, source, learning, &cells);
  builder.add<MaintainSharcPass>(cells);  // after reservoirs: it ends the part of the frame that can be stopped
}

/// Outputs of light paths besides the radiance. `chains`, here and below: destinations of new states.
BdptRecords bdpt_records(const RenderSettings& settings, const ChainRecordings& chains) {
  return {.splats = needs_splat_image(settings),
          .caustics = has_caustic_layer(settings),
          .first_vertices = needs_first_vertices(settings),
          .splats_apart = needs_first_vertices(settings) && settings.cache != CacheChoice::none,
          .first_scatters = resamples_direct_light(settings.reuse),
          .indirect_samples = resamples_indirect_light(settings.reuse),
          .chains = chains};
}

/// Adds light paths, without a cache and without reservoirs. `recording`, here and below: destination of path samples,
/// or nullptr.
void add_light_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                     const PathRecording* recording, const ChainRecordings& chains) {
  const BdptRecords records = bdpt_records(settings, chains);
  if (settings.estimator == EstimatorChoice::vcm) {
    builder.add_tracing<VcmPass, &RenderSettings::vcm, &RenderSettings::bdpt, &RenderSettings::light_selection>(
        settings.history != HistoryChoice::none, source, recording, records);
    return;
  }
  const BdptMode mode = settings.estimator == EstimatorChoice::light ? BdptMode::light_only : BdptMode::bidirectional;
  builder.add_tracing<BdptPass, &RenderSettings::bdpt, &RenderSettings::light_selection>(mode, source, recording,
                                                                                         records);
}

/// Adds light paths beside camera subpaths that fill cells.
void add_light_paths_with_cells(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                                const PathRecording* recording, const ChainRecordings& chains, const CellsPass& cells) {
  const BdptRecords records = bdpt_records(settings, chains);
  const bool adapts = settings.cache == CacheChoice::apsf;
  if (settings.estimator == EstimatorChoice::vcm) {
    builder.add_tracing<VcmCellsPass, &RenderSettings::vcm, &RenderSettings::bdpt, &RenderSettings::light_selection,
                        &RenderSettings::apsf>(adapts, cells, settings.history != HistoryChoice::none, source,
                                               recording, records);
    return;
  }
  builder.add_tracing<BdptCellsPass, &RenderSettings::bdpt, &RenderSettings::light_selection, &RenderSettings::apsf>(
      adapts, cells, source, recording, records);
}

/// Adds a pass of paths that fill cells. Unless reservoirs add the direct light of primary hits, cells take it with the
/// rest of a path, so paths resample lights there themselves.
template <typename P, auto... members, typename... Arguments>
void add_filling(PipelineBuilder& builder, Arguments&&... arguments) {
  P& pass = builder.add_tracing<P, members...>(std::forward<Arguments>(arguments)...);
  builder.add_follower(pass, [](const RenderSettings& s) {
    return PrimaryLightCandidates{s.reuse == ReuseChoice::ris ? static_cast<uint32_t>(s.ris.candidates) : 1u};
  });
}

/// Adds camera paths that fill cells.
void add_paths_with_cells(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                          const LearningRecords& learning, const CellsPass& cells) {
  switch (settings.cache) {
    case CacheChoice::none:
    case CacheChoice::sharc: break;
    case CacheChoice::psf: add_filling<PathSpaceFilterPass>(builder, source, cells, learning); break;
    case CacheChoice::apsf:
      add_filling<AdaptivePsfPass, &RenderSettings::apsf>(builder, source, cells, learning);
      break;
    case CacheChoice::apg:
    case CacheChoice::apsf_apg:
      add_filling<PathGraphPass, &RenderSettings::apg, &RenderSettings::apsf>(
          builder, settings.cache == CacheChoice::apsf_apg, source, cells, learning);
      break;
  }
}

/// Whether a pass of reservoirs adds the direct light of primary hits to pixels with cells.
bool has_direct_reservoirs(const RenderSettings& settings) {
  return resamples_direct_light(settings.reuse) && !paths_resample_lights(settings);
}

/// Adds the estimator with a cache that replaces parts of its paths.
void add_cached_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                      const LearningRecords& learning) {
  if (settings.cache == CacheChoice::sharc) return add_sharc(builder, settings, source, learning);
  const bool every_vertex = settings.cache == CacheChoice::apg || settings.cache == CacheChoice::apsf_apg;
  const bool has_splats = settings.estimator != EstimatorChoice::path;
  const CellPathUsers users{.history = needs_first_vertices(settings),
                            .reservoirs = has_direct_reservoirs(settings),
                            .indirect = resamples_indirect_light(settings.reuse),
                            .whole_paths = settings.reuse == ReuseChoice::restir_pt};
  const bool has_reservoirs = users.any_reservoirs();
  // With reservoirs of whole paths, only their candidates record samples.
  const LearningRecords own = users.whole_paths ? LearningRecords{} : learning;
  CellsPass& cells = builder.add<CellsPass, &RenderSettings::psf>(every_vertex ? kGraphDepths : 1u, users);
  if (has_splats) {
    add_light_paths_with_cells(builder, settings, source, learning.samples, learning.chains, cells);
  } else {
    add_paths_with_cells(builder, settings, source, own, cells);
  }
  // Before the cells are read: with that, the part of the frame that can be stopped ends.
  if (has_reservoirs) add_reuse(builder, settings, source, learning, &cells);
  // With reservoirs of paths, pixels show no cells, and edges would be found without any reflected light.
  const bool sharpens_edges = settings.denoise == DenoiseChoice::none && !users.whole_paths;
  builder.add_tracing<ResolveCellsPass>(source, cells, sharpens_edges, has_splats || has_reservoirs);
}

}  // namespace

bool skips_pixels(const RenderSettings& settings) {
  return settings.allocation == AllocationChoice::adaptive || upscales(settings);
}

bool needs_splat_image(const RenderSettings& settings) {
  return settings.estimator != EstimatorChoice::path && skips_pixels(settings);
}

bool paths_resample_lights(const RenderSettings& settings) {
  return settings.reuse == ReuseChoice::ris && settings.estimator == EstimatorChoice::path &&
         settings.cache != CacheChoice::none && settings.cache != CacheChoice::sharc;
}

bool has_caustic_layer(const RenderSettings& settings) {
  return settings.bdpt.caustic_layer && settings.estimator != EstimatorChoice::path &&
         (settings.denoise != DenoiseChoice::none || settings.auxiliary);
}

bool denoiser_splits(const RenderSettings& settings) { return can_split(settings) && denoiser_fills(settings); }
bool history_splits(const RenderSettings& settings) {
  return can_split(settings) && settings.history == HistoryChoice::reproject &&
         settings.reproject.method == ReprojectionMethod::backward;
}
bool splits_light(const RenderSettings& settings) { return denoiser_splits(settings) || history_splits(settings); }

PathPass* add_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                    const PathRecording* recording, const ChainRecordings& chains) {
  const LearningRecords learning{recording, chains};
  if (settings.cache != CacheChoice::none) {
    add_cached_paths(builder, settings, source, learning);
    return nullptr;
  }
  if (settings.estimator != EstimatorChoice::path) {
    add_light_paths(builder, settings, source, recording, chains);
    add_reuse(builder, settings, source, learning);
    return nullptr;
  }
  const PathRecords records{.first_vertices = needs_first_vertices(settings),
                            .specular = splits_light(settings),
                            .first_scatters = resamples_direct_light(settings.reuse),
                            .indirect_samples = resamples_indirect_light(settings.reuse),
                            .only_specular = settings.reuse == ReuseChoice::restir_pt};
  const LearningRecords own = records.only_specular ? LearningRecords{} : learning;
  auto& paths = builder.add_tracing<PathPass>(source, records, own.samples, own.chains);
  add_reuse(builder, settings, source, learning);
  return &paths;
}

}  // namespace relume
