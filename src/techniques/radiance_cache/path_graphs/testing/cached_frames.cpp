#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

#include <utility>

#include "scene/world_triangles.h"
#include "techniques/radiance_cache/path_space_filter/sampled_cells.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "techniques/transport/path/recording_output.h"

namespace relume::testing {
namespace {

OctreeTree tree_around(const SceneView& scene) {
  const Box box = world_box(scene);
  return OctreeTree(box.center(), 1.001f * max_component(box.extent()));
}

}  // namespace

CachedFrames::CachedFrames(Scene scene, const CachedFrameSettings& settings)
    : settings_(settings),
      scene_(std::move(scene), CompileOptions{.camera = {}, .width = settings.width, .height = settings.height}),
      backend_(settings.threads),
      grid_(settings.psf.grid, settings.expected_cells),
      power_(build_power_lights(scene_.view().lights)),
      tree_(tree_around(scene_.view())) {
  const auto pixels = static_cast<size_t>(settings.width) * static_cast<size_t>(settings.height);
  hits_.resize(pixels);
  pixels_.resize(pixels);
  if (settings.psf.split || settings.psf.refine > 0.0f) others_.resize(pixels);
  if (settings.recorded) {
    records_.resize(kRecordedVertices * pixels);
    directions_.resize(records_.size());
    lights_.resize(records_.size());
  }
  if (settings.sampled) samples_.resize(pixels);
  rays_.resize(pixels);
  radiance_.resize(pixels);
}

PathRecording CachedFrames::recording() {
  return {.octree = tree_.view(),
          .lookup = {.tree = tree_.view()},
          .samples = mutable_view_of(records_),
          .vertices = kRecordedVertices,
          .pixels = static_cast<uint32_t>(pixels_.size())};
}

ChainOutput CachedFrames::chains() {
  const auto pixels = static_cast<uint32_t>(pixels_.size());
  ChainOutput output;
  output.guide.guide.grid = output.lights.chains.grid = FilledTable<GuideState>().grid;
  output.guide.out = {mutable_view_of(directions_), kRecordedVertices, pixels};
  output.lights.out = {mutable_view_of(lights_), kRecordedVertices, pixels};
  return output;
}

template <typename Cache>
void CachedFrames::trace_cells(const PathContext& context, const SampleIndex& index, const Cache& cache) {
  const CellsOutput<Cache> cells{cache, mutable_view_of(pixels_)};
  if (settings_.sampled) {
    const CachedRecordingOutput records{recording()};
    const IndirectSampleOutput samples{mutable_view_of(samples_)};
    return trace_in_order<Cache>(cells, samples, [&](const auto& first, const auto& second) {
      trace(context, index, records, CachedChainOutput{chains()}, first, second);
    });
  }
  if (settings_.recorded)
    return trace(context, index, CachedRecordingOutput{recording()}, CachedChainOutput{chains()}, cells);
  if (!settings_.watched) return trace(context, index, cells);
  first_vertices_.resize(pixels_.size());
  specular_.resize(pixels_.size());
  trace(context, index, FirstVertexOutput{mutable_view_of(first_vertices_)}, SpecularOutput{mutable_view_of(specular_)},
        cells);
}

template <typename... Outputs>
void CachedFrames::trace(const PathContext& context, const SampleIndex& index, const Outputs&... outputs) {
  run("trace", PathKernel<Outputs...>{
                   context, index, view_of(hits_), {}, mutable_view_of(rays_), width(), path_outputs(outputs...)});
}

template <typename Kernel>
void CachedFrames::run(const char* name, const Kernel& kernel) {
  launch(backend_, name, kernel, width(), static_cast<uint32_t>(settings_.height));
}

const std::vector<Rgb>& CachedFrames::render() {
  trace();
  resolve();
  grid_.adjust_size(backend_);
  ++frame_;
  return radiance_;
}

void CachedFrames::trace() {
  const SampleIndex index{.seed = settings_.seed, .sequence = frame_, .frame = frame_};
  const SceneView view = scene_.view();
  run("gbuffer", PrimaryHitsKernel{view, index, mutable_view_of(hits_), {}, width()});
  PathContext context;
  context.scene = view;
  context.selector.uniform = make_uniform_lights(view.lights);
  context.selector.power = {{view_of(power_)}};
  context.max_bounces = settings_.max_bounces;
  context.russian_roulette = settings_.russian_roulette;
  FilterContext filter{grid_.view(view.camera),     sqr(settings_.psf.min_roughness), settings_.psf.split,
                       settings_.psf.refine > 0.0f, mutable_view_of(others_),         width()};
  filter.indirect_apart = settings_.sampled;
  const bool graph_shown = settings_.kind == CacheKind::apsf_apg;
  AdaptivePsf adaptive = make_adaptive_psf(settings_.apsf, graph_shown ? BlendFunction::zero : BlendFunction::one);
  switch (settings_.kind) {
    case CacheKind::none: {
      const RadianceOutput radiance{mutable_view_of(radiance_)};
      if (settings_.sampled) {
        trace(context, index, radiance, CachedRecordingOutput{recording()}, CachedChainOutput{chains()},
              IndirectSampleOutput{mutable_view_of(samples_)});
      } else if (settings_.recorded) {
        trace(context, index, radiance, RecordingOutput{recording()}, chains());
      } else {
        trace(context, index, radiance);
      }
      break;
    }
    case CacheKind::psf: trace_cells(context, index, filter); break;
    case CacheKind::apsf: trace_cells(context, index, AdaptiveFilterContext{filter, adaptive}); break;
    case CacheKind::apg: adaptive.enabled = false; [[fallthrough]];
    case CacheKind::apsf_apg:
      const PathGraphContext graph{filter,
                                   adaptive,
                                   settings_.apg.variance_constant,
                                   settings_.apg.variance,
                                   settings_.apg.feed,
                                   static_cast<uint16_t>(settings_.apg.deep_coarsening),
                                   settings_.apg.guards};
      trace_cells(context, index, graph);
      break;
  }
}

void CachedFrames::resolve() {
  if (settings_.kind == CacheKind::none) return;
  grid_.advance(backend_);
  run("resolve", ResolveCellsKernel{grid_.view(scene_.view().camera),
                                    view_of(pixels_),
                                    mutable_view_of(radiance_),
                                    layers_,
                                    width(),
                                    {},
                                    {},
                                    settings_.psf.refine,
                                    view_of(others_)});
}

}  // namespace relume::testing
