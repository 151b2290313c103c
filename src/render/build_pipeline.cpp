#include "render/build_pipeline.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "render/pipeline_builder.h"
#include "techniques/denoise/asvgf/asvgf_pass.h"
#include "techniques/denoise/bmfr/bmfr_pass.h"
#include "techniques/denoise/caustic_layer/caustic_layer_pass.h"
#include "techniques/denoise/firefly_clamp/firefly_clamp_pass.h"
#include "techniques/denoise/oidn/oidn_pass.h"
#include "techniques/denoise/shared/edge_emission_pass.h"
#include "techniques/denoise/shared/split_light_pass.h"
#include "techniques/denoise/svgf/svgf_pass.h"
#include "techniques/gbuffer/features/features_pass.h"
#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"
#include "techniques/guiding/direction_view/direction_view_pass.h"
#include "techniques/light_sampling/light_selection/light_selection_pass.h"
#include "techniques/light_sampling/light_tree/light_tree_pass.h"
#include "techniques/light_sampling/static_light_lists/static_light_lists_pass.h"
#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache_pass.h"
#include "techniques/radiance_cache/adaptive_psf/adaptive_psf_pass.h"
#include "techniques/radiance_cache/adaptive_psf/subpath_cells_pass.h"
#include "techniques/radiance_cache/path_graphs/path_graphs_pass.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter_pass.h"
#include "techniques/radiance_cache/sharc/sharc_pass.h"
#include "techniques/reuse/reservoir/ris_pass.h"
#include "techniques/reuse/restir_di/restir_pass.h"
#include "techniques/spatial/octree/octree_pass.h"
#include "techniques/temporal/accumulate/accumulate_pass.h"
#include "techniques/temporal/adaptive_sampling/adaptive_sampling_pass.h"
#include "techniques/temporal/reprojection/reprojection_pass.h"
#include "techniques/temporal/reprojection/specular_history_pass.h"
#include "techniques/temporal/upscaling/upscaling_pass.h"
#include "techniques/transport/bdpt/bdpt_pass.h"
#include "techniques/transport/path/path_pass.h"
#include "techniques/transport/vcm/vcm_pass.h"

namespace relume {
namespace {

/// Whether a pass of a stage before `end` reads any of the buffers.
bool read_before(const Pipeline& pipeline, Stage end, const std::vector<BufferDescription>& buffers) {
  const auto is_one = [&](const BufferId& id) {
    return std::any_of(buffers.begin(), buffers.end(),
                       [&](const BufferDescription& buffer) { return buffer.id == id; });
  };
  const std::vector<PassDeclaration> list = pipeline.declarations();
  return std::any_of(list.begin(), list.end(), [&](const PassDeclaration& pass) {
    return pass.stage < end && (std::any_of(pass.reads.begin(), pass.reads.end(), is_one) ||
                                std::any_of(pass.reads_if_any.begin(), pass.reads_if_any.end(), is_one));
  });
}

bool reads_surface(const Pipeline& pipeline) {
  const std::vector<BufferDescription> surface = SurfacePass().declaration().owns;
  const auto is_surface = [&](const BufferId& buffer) {
    return std::any_of(surface.begin(), surface.end(),
                       [&](const BufferDescription& owned) { return owned.id == buffer; });
  };
  const std::vector<PassDeclaration> list = pipeline.declarations();
  return std::any_of(list.begin(), list.end(), [&](const PassDeclaration& pass) {
    return std::any_of(pass.reads.begin(), pass.reads.end(), is_surface);
  });
}

/// Whether primary hits are only read at pixels with a sample.
bool only_samples_read_hits(const Pipeline& pipeline) {
  const std::vector<PassDeclaration> list = pipeline.declarations();
  return std::none_of(list.begin(), list.end(), [](const PassDeclaration& pass) {
    const bool reads_hits = std::find(pass.reads.begin(), pass.reads.end(), BufferId(kPrimaryHits)) != pass.reads.end();
    return reads_hits && !pass.only_sampled_pixels;
  });
}

OctreePass& add_octree(PipelineBuilder& builder, bool adds_up) {
  OctreePass& octree = builder.add<OctreePass, &RenderSettings::octree>(adds_up);
  builder.add_follower(octree, [](const RenderSettings& s) {
    return RecordUsers{.lights = s.lights == LightSelectionChoice::vlc,
                       .infinite_lights = s.vlc.lists_infinite(),
                       .directions = s.guide == GuideChoice::cdq};
  });
  return octree;
}

const LightSelector& add_light_selection(PipelineBuilder& builder, const RenderSettings& settings,
                                         const OctreePass* octree) {
  switch (settings.lights) {
    case LightSelectionChoice::uniform:
      return builder.add<LightSelectionPass, &RenderSettings::light_selection>(LightSelectorKind::uniform).selector();
    case LightSelectionChoice::power: break;
    case LightSelectionChoice::light_tree:
      return builder.add<LightTreePass, &RenderSettings::light_selection>().selector();
    case LightSelectionChoice::static_lists:
      return builder.add<StaticLightListsPass, &RenderSettings::static_lists, &RenderSettings::light_selection>()
          .selector();
    case LightSelectionChoice::vlc: {
      auto& cache =
          builder.add<VisibilityLightCachePass, &RenderSettings::vlc, &RenderSettings::light_selection>(*octree);
      builder.add<KnownLightsPass>(*octree, cache);
      return cache.selector();
    }
  }
  return builder.add<LightSelectionPass, &RenderSettings::light_selection>(LightSelectorKind::power).selector();
}

const DirectionSampler& add_direction_sampling(PipelineBuilder& builder, const RenderSettings& settings,
                                               const OctreePass* octree) {
  static const DirectionSampler bsdf_directions;
  if (settings.guide == GuideChoice::bsdf) return bsdf_directions;
  return builder.add<DirectionalQuadtreePass, &RenderSettings::cdq>(*octree).directions();
}

/// Whether frames leave pixels without a sample.
bool skips_pixels(const RenderSettings& settings) {
  return settings.allocation == AllocationChoice::adaptive || upscales(settings);
}

/// Whether light paths reach pixels without a camera sample.
bool needs_splat_image(const RenderSettings& settings) {
  return settings.estimator != EstimatorChoice::path && skips_pixels(settings);
}

/// Whether frames have a caustic layer: if a denoiser filters it, or for the layers beside the image.
bool has_caustic_layer(const RenderSettings& settings) {
  return settings.bdpt.caustic_layer && settings.estimator != EstimatorChoice::path &&
         (settings.denoise != DenoiseChoice::none || settings.auxiliary);
}

/// Settings of the filter of the caustic layer: those of the denoiser, as far as it has them.
SvgfSettings caustic_filter(const RenderSettings& settings) {
  if (settings.denoise == DenoiseChoice::svgf) return settings.svgf;
  if (settings.denoise == DenoiseChoice::asvgf) return svgf_settings(settings.asvgf, false);
  SvgfSettings filter;
  filter.history = settings.bmfr.history;
  return filter;
}

/// Whether diffuse and specular light are separated. Only path tracing without a radiance cache can separate them.
bool can_split(const RenderSettings& settings) {
  return settings.features.split && settings.estimator == EstimatorChoice::path && settings.cache == CacheChoice::none;
}
bool denoiser_splits(const RenderSettings& settings) { return can_split(settings) && denoiser_fills(settings); }
bool history_splits(const RenderSettings& settings) {
  return can_split(settings) && settings.history == HistoryChoice::reproject &&
         settings.reproject.method == ReprojectionMethod::backward;
}
bool splits_light(const RenderSettings& settings) { return denoiser_splits(settings) || history_splits(settings); }

/// Adds the reservoirs for direct light at primary hits.
void add_reuse(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
               const PathRecording* recording) {
  switch (settings.reuse) {
    case ReuseChoice::none: break;
    case ReuseChoice::ris: builder.add_tracing<RisPass, &RenderSettings::ris>(source, recording); break;
    case ReuseChoice::restir_di:
      builder.add_tracing<RestirPass, &RenderSettings::ris, &RenderSettings::restir>(source, recording);
      break;
  }
}

/// Adds path tracing with the spatially hashed radiance cache.
void add_sharc(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source) {
  auto& cells =
      builder.add<CellsPass>(cell_settings(settings.sharc), cell_depths(settings.sharc).count, false, "sharc");
  builder.add_follower(cells, [](const RenderSettings& s) { return cell_settings(s.sharc); });
  builder.add_follower(cells, [](const RenderSettings& s) { return cell_depths(s.sharc); });
  builder.add_tracing<SharcPass, &RenderSettings::sharc>(source, cells);
  builder.add<MaintainSharcPass>(cells);
}

/// Outputs of light paths besides the radiance.
BdptRecords bdpt_records(const RenderSettings& settings) {
  return {.splats = needs_splat_image(settings),
          .caustics = has_caustic_layer(settings),
          .first_vertices = needs_first_vertices(settings)};
}

/// Adds light paths, without a cache. `recording`, here and below: destination of path samples, or nullptr.
void add_light_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                     const PathRecording* recording) {
  const BdptRecords records = bdpt_records(settings);
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
                                const PathRecording* recording, const CellsPass& cells) {
  const BdptRecords records = bdpt_records(settings);
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

/// Adds camera paths that fill cells.
void add_paths_with_cells(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                          const PathRecording* recording, const CellsPass& cells) {
  switch (settings.cache) {
    case CacheChoice::none:
    case CacheChoice::sharc: break;
    case CacheChoice::psf: builder.add_tracing<PathSpaceFilterPass>(source, cells, recording); break;
    case CacheChoice::apsf:
      builder.add_tracing<AdaptivePsfPass, &RenderSettings::apsf>(source, cells, recording);
      break;
    case CacheChoice::apg:
    case CacheChoice::apsf_apg:
      builder.add_tracing<PathGraphPass, &RenderSettings::apg, &RenderSettings::apsf>(
          settings.cache == CacheChoice::apsf_apg, source, cells, recording);
      break;
  }
}

/// Adds the estimator with a cache that replaces parts of its paths.
void add_cached_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                      const PathRecording* recording) {
  if (settings.cache == CacheChoice::sharc) return add_sharc(builder, settings, source);
  const bool every_vertex = settings.cache == CacheChoice::apg || settings.cache == CacheChoice::apsf_apg;
  const bool has_splats = settings.estimator != EstimatorChoice::path;
  CellsPass& cells =
      builder.add<CellsPass, &RenderSettings::psf>(every_vertex ? kGraphDepths : 1u, needs_first_vertices(settings));
  if (has_splats) {
    add_light_paths_with_cells(builder, settings, source, recording, cells);
  } else {
    add_paths_with_cells(builder, settings, source, recording, cells);
  }
  builder.add_tracing<ResolveCellsPass>(source, cells, settings.denoise == DenoiseChoice::none, has_splats);
}

/// Adds the estimator. `octree`: destination of path samples, or nullptr. Returns the pass of path tracing without a
/// cache, or nullptr.
PathPass* add_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                    const OctreePass* octree) {
  const PathRecording* const recording = octree ? &octree->recording() : nullptr;
  if (octree) builder.add<RegionViewPass>(*octree);
  if (settings.cache != CacheChoice::none) {
    add_cached_paths(builder, settings, source, recording);
    return nullptr;
  }
  if (settings.estimator != EstimatorChoice::path) {
    add_light_paths(builder, settings, source, recording);
    return nullptr;
  }
  const PathRecords records{.first_vertices = needs_first_vertices(settings),
                            .specular = splits_light(settings),
                            .first_scatters = settings.reuse != ReuseChoice::none};
  auto& paths = builder.add_tracing<PathPass>(source, records, recording);
  add_reuse(builder, settings, source, recording);
  return &paths;
}

/// Changes that end the history.
Change ends_history(const RenderSettings& settings) {
  return settings.history == HistoryChoice::reproject ? Change::materials | Change::settings : Change::any;
}

uint32_t pixel_count(const RenderSettings& settings) {
  return static_cast<uint32_t>(settings.width) * static_cast<uint32_t>(settings.height);
}

void add_history(PipelineBuilder& builder, const RenderSettings& settings) {
  const AccumulatedParts parts{.m2_rgb = settings.allocation == AllocationChoice::adaptive,
                               .splat_image = needs_splat_image(settings),
                               .specular = history_splits(settings),
                               .caustics = has_caustic_layer(settings),
                               .cells = needs_first_vertices(settings) && settings.cache != CacheChoice::none};
  if (settings.history == HistoryChoice::reproject) {
    if (parts.specular) builder.add<SpecularHistoryPass, &RenderSettings::reproject>();
    const HistoryContents contents{
        .m2_rgb = parts.m2_rgb, .cells = parts.cells, .light_points = settings.reuse != ReuseChoice::none};
    auto& reprojection = builder.add<ReprojectionPass, &RenderSettings::reproject>(pixel_count(settings), contents);
    if (settings.reproject.method == ReprojectionMethod::forward)
      builder.add<StoreSamplesPass, &RenderSettings::reproject>(reprojection);
  }
  builder.add<AccumulatePass>(ends_history(settings), settings.history != HistoryChoice::none, parts);
}

void add_allocation(PipelineBuilder& builder, const RenderSettings& settings) {
  if (!skips_pixels(settings)) return;
  builder.add<SampleCountPass>();
  if (upscales(settings)) {
    builder.add<BlockAllocationPass, &RenderSettings::upscaling>();
  } else {
    builder.add<AdaptiveSamplingPass, &RenderSettings::adaptive>(ends_history(settings));
  }
}

/// Whether the estimator shows images in mirrors.
bool shows_mirrors(const RenderSettings& settings) { return settings.estimator != EstimatorChoice::light; }

/// Adds noise-free features if a denoiser or a history needs them.
FeaturesPass* add_features(PipelineBuilder& builder, const RenderSettings& settings) {
  if (settings.denoise == DenoiseChoice::none && !history_splits(settings)) return nullptr;
  return &builder.add<FeaturesPass, &RenderSettings::path>(shows_mirrors(settings), splits_light(settings));
}

/// Lets paths hand their first surfaces to the features where each pixel has a path and no pass before the paths reads
/// features.
void join(const Pipeline& pipeline, const RenderSettings& settings, PathPass* paths, FeaturesPass* features) {
  if (!paths || !features || skips_pixels(settings)) return;
  if (read_before(pipeline, Stage::trace, features->declaration().owns)) return;
  paths->hand_surfaces_to(features->from_paths());
}

/// `gradients`: changes of light for A-SVGF; nullptr: the paths cannot be traced again.
void add_denoiser(PipelineBuilder& builder, const RenderSettings& settings, const GradientPass* gradients) {
  if (settings.denoise == DenoiseChoice::none) return;
  const bool mirrors = shows_mirrors(settings);
  const bool split = denoiser_splits(settings);
  builder.add<EdgeEmissionPass, &RenderSettings::features, &RenderSettings::path>(mirrors);
  if (split) builder.add<SplitLightPass>();
  const bool caustics = has_caustic_layer(settings);
  if (caustics && denoiser_fills(settings)) {
    builder.add_follower(builder.add<CausticLayerPass>(), [](const RenderSettings& s) { return caustic_filter(s); });
  }
  switch (settings.denoise) {
    case DenoiseChoice::none: break;
    case DenoiseChoice::bmfr: builder.add<BmfrPass, &RenderSettings::bmfr>(split); break;
    case DenoiseChoice::svgf: builder.add<SvgfPass, &RenderSettings::svgf>(split); break;
    case DenoiseChoice::asvgf: builder.add<AsvgfPass, &RenderSettings::asvgf>(split, gradients); break;
    case DenoiseChoice::oidn: builder.add<OidnPass>(caustics); break;
  }
}

}  // namespace

bool needs_first_vertices(const RenderSettings& settings) {
  return settings.history == HistoryChoice::reproject && settings.reproject.method == ReprojectionMethod::forward;
}

bool upscales(const RenderSettings& settings) { return settings.upscaling.factor > 1 || settings.switches_upscaling; }

bool learns(const RenderSettings& settings) {
  return settings.lights == LightSelectionChoice::vlc || settings.guide == GuideChoice::cdq;
}

bool denoiser_fills(const RenderSettings& settings) {
  return settings.denoise == DenoiseChoice::svgf || settings.denoise == DenoiseChoice::asvgf ||
         settings.denoise == DenoiseChoice::bmfr;
}

Change ends_sequences(const RenderSettings& settings) {
  if (learns(settings)) return Change::any;
  // A history moved to another pixel has no sequence to continue.
  return ends_history(settings) | Change::camera;
}

uint32_t pilot_samples(const RenderSettings& settings) {
  const bool has_pilot = settings.allocation == AllocationChoice::adaptive && settings.adaptive.pilot;
  return has_pilot ? static_cast<uint32_t>(settings.adaptive.max_samples) : 0;
}

FramePasses build_passes(const RenderSettings& settings, Memory& memory) {
  check_combination(settings);
  FramePasses passes;
  PipelineBuilder builder(settings, passes, memory);
  const bool adds_up = settings.history != HistoryChoice::none;
  const OctreePass* octree = learns(settings) ? &add_octree(builder, adds_up) : nullptr;
  const LightSelector& selector = add_light_selection(builder, settings, octree);
  const DirectionSampler& directions = add_direction_sampling(builder, settings, octree);
  const PathSource source{settings.path, selector, directions};
  PathPass* const paths = add_paths(builder, settings, source, octree);
  // Paths alone lack the light that reservoirs add to the image.
  const bool whole_paths = paths && !octree && settings.reuse == ReuseChoice::none;
  const bool repeats = whole_paths && settings.denoise == DenoiseChoice::asvgf;
  const GradientPass* const gradients =
      repeats ? &builder.add_tracing<GradientPass, &RenderSettings::asvgf>(source) : nullptr;
  if (settings.firefly.limit > 0) builder.add<FireflyClampPass, &RenderSettings::firefly>();
  if (settings.guide == GuideChoice::cdq) builder.add_tracing<DirectionViewPass, &RenderSettings::cdq>(source, *octree);
  add_history(builder, settings);
  add_allocation(builder, settings);
  if (upscales(settings) && !denoiser_fills(settings)) builder.add<FillUnsampledPass, &RenderSettings::upscaling>();
  if (settings.auxiliary) builder.add<AuxiliaryPass>();
  FeaturesPass* const features = add_features(builder, settings);
  add_denoiser(builder, settings, gradients);
  join(builder.pipeline(), settings, paths, features);
  if (reads_surface(builder.pipeline())) builder.add<SurfacePass>();
  builder.add<PrimaryHitsPass>(only_samples_read_hits(builder.pipeline()));
  passes.pipeline.check();
  return passes;
}

void configure(const FramePasses& passes, const RenderSettings& settings) {
  for (const auto& follow : passes.followers) follow(settings);
}

std::vector<PassDeclaration> plan(const RenderSettings& settings) {
  return build_passes(settings, host_memory()).pipeline.declarations();
}

}  // namespace relume
