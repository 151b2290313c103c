#include "render/build_pipeline.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "render/estimator_passes.h"
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
#include "techniques/guiding/markov_chain/markov_chain_pass.h"
#include "techniques/light_sampling/adaptive_tiles/adaptive_tiles_pass.h"
#include "techniques/light_sampling/light_selection/light_selection_pass.h"
#include "techniques/light_sampling/light_tree/light_tree_pass.h"
#include "techniques/light_sampling/markov_chain_lights/markov_chain_lights_pass.h"
#include "techniques/light_sampling/static_light_lists/static_light_lists_pass.h"
#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache_pass.h"
#include "techniques/spatial/octree/octree_pass.h"
#include "techniques/temporal/accumulate/accumulate_pass.h"
#include "techniques/temporal/accumulate/sample_sums_pass.h"
#include "techniques/temporal/adaptive_sampling/adaptive_sampling_pass.h"
#include "techniques/temporal/reprojection/reprojection_pass.h"
#include "techniques/temporal/reprojection/specular_history_pass.h"
#include "techniques/temporal/upscaling/upscaling_pass.h"
#include "techniques/transport/path/path_pass.h"

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
                       .directions = s.guide == GuideChoice::cdq,
                       .importance = learns_importance(s)};
  });
  return octree;
}

/// Adds the light selection. `recording`: destination of samples for learning, from the octree or nullptr; becomes that
/// of the light selection if it takes more.
const LightSelector& add_light_selection(PipelineBuilder& builder, const RenderSettings& settings,
                                         const OctreePass* octree, const PathRecording*& recording,
                                         ChainRecordings& chains) {
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
    case LightSelectionChoice::neeat: {
      auto& tiles = builder.add<AdaptiveTilesPass, &RenderSettings::neeat, &RenderSettings::light_selection>(
          octree, settings.history != HistoryChoice::none);
      recording = &tiles.recording();
      return tiles.selector();
    }
    case LightSelectionChoice::mcls: {
      auto& lights = builder.add<MarkovChainLightsPass, &RenderSettings::mcls, &RenderSettings::light_selection>();
      chains.lights = &lights.recording();
      return lights.selector();
    }
  }
  return builder.add<LightSelectionPass, &RenderSettings::light_selection>(LightSelectorKind::power).selector();
}

const DirectionSampler& add_direction_sampling(PipelineBuilder& builder, const RenderSettings& settings,
                                               const OctreePass* octree, ChainRecordings& chains) {
  static const DirectionSampler bsdf_directions;
  if (settings.guide == GuideChoice::bsdf) return bsdf_directions;
  if (settings.guide == GuideChoice::mcpg) {
    auto& guide = builder.add<MarkovChainPass, &RenderSettings::mcpg>();
    chains.guide = &guide.recording();
    return guide.directions();
  }
  return builder.add<DirectionalQuadtreePass, &RenderSettings::cdq>(*octree).directions();
}

/// Settings of the filter of the caustic layer: those of the denoiser, as far as it has them.
SvgfSettings caustic_filter(const RenderSettings& settings) {
  if (settings.denoise == DenoiseChoice::svgf) return settings.svgf;
  if (settings.denoise == DenoiseChoice::asvgf) return svgf_settings(settings.asvgf, false);
  SvgfSettings filter;
  filter.history = settings.bmfr.history;
  return filter;
}

/// Whether the history stores the light of cells separately, to look cells up from a new view. Cells of sharc, and
/// those of paths in reservoirs, replace light behind rough surfaces, which the history moves with other light.
bool looks_up_cells(const RenderSettings& settings) {
  const bool has_cells = settings.cache != CacheChoice::none && settings.cache != CacheChoice::sharc;
  return needs_first_vertices(settings) && has_cells && settings.reuse != ReuseChoice::restir_pt;
}

/// Whether first vertices record points of reservoirs on lights. Paths that fill cells and choose among lights
/// themselves record random numbers instead.
bool records_light_points(const RenderSettings& settings) {
  return resamples_direct_light(settings.reuse) && !paths_resample_lights(settings);
}

/// Whether first vertices record directions of splats beside the light of cells.
bool has_splats_beside_cells(const RenderSettings& settings) {
  return looks_up_cells(settings) && settings.estimator != EstimatorChoice::path;
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
                               .cells = looks_up_cells(settings)};
  if (settings.history == HistoryChoice::reproject) {
    if (parts.specular) builder.add<SpecularHistoryPass, &RenderSettings::reproject>();
    const HistoryContents contents{.m2_rgb = parts.m2_rgb,
                                   .cells = parts.cells,
                                   .light_points = records_light_points(settings),
                                   .splats_apart = has_splats_beside_cells(settings),
                                   .indirect_apart = resamples_indirect_light(settings.reuse)};
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
  return learns_regions(settings) || settings.lights == LightSelectionChoice::neeat || learns_in_chains(settings);
}

bool learns_regions(const RenderSettings& settings) {
  return settings.lights == LightSelectionChoice::vlc || settings.guide == GuideChoice::cdq;
}

bool learns_importance(const RenderSettings& settings) {
  return settings.guide == GuideChoice::cdq && settings.cdq.importance && settings.estimator != EstimatorChoice::path;
}

bool learns_in_chains(const RenderSettings& settings) {
  return settings.lights == LightSelectionChoice::mcls || settings.guide == GuideChoice::mcpg;
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
  const OctreePass* octree = learns_regions(settings) ? &add_octree(builder, adds_up) : nullptr;
  const PathRecording* recording = octree ? &octree->recording() : nullptr;
  ChainRecordings chains;
  const LightSelector& selector = add_light_selection(builder, settings, octree, recording, chains);
  const DirectionSampler& directions = add_direction_sampling(builder, settings, octree, chains);
  const PathSource source{settings.path, selector, directions};
  if (octree) builder.add<RegionViewPass>(*octree);
  PathPass* const paths = add_paths(builder, settings, source, recording, chains);
  // Paths alone lack the light that reservoirs add to the image.
  const bool whole_paths = paths && !learns(settings) && settings.reuse == ReuseChoice::none;
  const bool repeats = whole_paths && settings.denoise == DenoiseChoice::asvgf;
  const GradientPass* const gradients =
      repeats ? &builder.add_tracing<GradientPass, &RenderSettings::asvgf>(source) : nullptr;
  if (settings.firefly.limit > 0) builder.add<FireflyClampPass, &RenderSettings::firefly>();
  if (settings.guide == GuideChoice::cdq) builder.add_tracing<DirectionViewPass, &RenderSettings::cdq>(source, *octree);
  add_history(builder, settings);
  if (settings.samples.sums) builder.add<SampleSumsPass>(settings.auxiliary);
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
