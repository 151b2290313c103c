// Frames of all caches in a hash grid without a session, for tests and benchmarks.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scene/compiled_scene.h"
#include "techniques/radiance_cache/adaptive_psf/settings.h"
#include "techniques/radiance_cache/path_graphs/path_graphs.h"
#include "techniques/radiance_cache/path_graphs/settings.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/specular_part.h"

namespace relume::testing {

enum class CacheKind { none, psf, apsf, apg, apsf_apg };
inline constexpr CacheKind kCacheKinds[] = {CacheKind::psf, CacheKind::apsf, CacheKind::apg, CacheKind::apsf_apg};

inline std::string name_of(CacheKind kind) {
  const char* names[] = {"none", "psf", "apsf", "apg", "apsf_apg"};
  return names[static_cast<int>(kind)];
}

struct CachedFrameSettings {
  CacheKind kind = CacheKind::psf;
  int width = 64;
  int height = 64;
  int threads = 1;
  uint32_t max_bounces = 8;
  uint32_t seed = 0;
  bool russian_roulette = true;
  bool watched = false;  ///< whether two policies observe the paths that the cache modifies
  PathSpaceFilterSettings psf;
  AdaptivePsfSettings apsf;
  PathGraphSettings apg;
  uint64_t expected_cells = 1 << 14;
};

class CachedFrames {
 public:
  CachedFrames(Scene scene, const CachedFrameSettings& settings)
      : settings_(settings),
        scene_(std::move(scene), CompileOptions{.camera = {}, .width = settings.width, .height = settings.height}),
        backend_(settings.threads),
        grid_(settings.psf.grid, settings.expected_cells),
        power_(build_power_lights(scene_.view().lights)) {
    const auto pixels = static_cast<size_t>(settings.width) * static_cast<size_t>(settings.height);
    hits_.resize(pixels);
    pixels_.resize(pixels);
    rays_.resize(pixels);
    radiance_.resize(pixels);
  }

  HashGrid& grid() { return grid_; }
  CompiledScene& scene() { return scene_; }
  Backend& backend() { return backend_; }
  const std::vector<FilteredPixel>& pixels() const { return pixels_; }
  const std::vector<Rgb>& radiance() const { return radiance_; }
  CellLayers& layers() { return layers_; }
  uint64_t rays() const {
    uint64_t sum = 0;
    for (const uint32_t r : rays_) sum += r;
    return sum;
  }

  /// Renders one sample per pixel; returns the image.
  const std::vector<Rgb>& render() {
    trace();
    resolve();
    grid_.adjust_size(backend_);
    ++frame_;
    return radiance_;
  }

  void trace() {
    const SampleIndex index{.seed = settings_.seed, .sequence = frame_, .frame = frame_};
    const SceneView view = scene_.view();
    run("gbuffer", PrimaryHitsKernel{view, index, mutable_view_of(hits_), {}, width()});
    PathContext context;
    context.scene = view;
    context.selector.uniform = make_uniform_lights(view.lights);
    context.selector.power = {{view_of(power_)}};
    context.max_bounces = settings_.max_bounces;
    context.russian_roulette = settings_.russian_roulette;
    FilterContext filter{grid_.view(view.camera), sqr(settings_.psf.min_roughness)};
    const bool graph_shown = settings_.kind == CacheKind::apsf_apg;
    AdaptivePsf adaptive = make_adaptive_psf(settings_.apsf, graph_shown ? BlendFunction::zero : BlendFunction::one);
    switch (settings_.kind) {
      case CacheKind::none: trace(context, index, RadianceOutput{mutable_view_of(radiance_)}); break;
      case CacheKind::psf: trace_cells(context, index, filter); break;
      case CacheKind::apsf: trace_cells(context, index, AdaptiveFilterContext{filter, adaptive}); break;
      case CacheKind::apg: adaptive.enabled = false; [[fallthrough]];
      case CacheKind::apsf_apg:
        const PathGraphContext graph{filter,
                                     adaptive,
                                     settings_.apg.variance_constant,
                                     settings_.apg.variance,
                                     settings_.apg.feed,
                                     static_cast<uint16_t>(settings_.apg.deep_coarsening)};
        trace_cells(context, index, graph);
        break;
    }
  }

  /// Pools the frame's samples with the cells and computes the image.
  void resolve() {
    if (settings_.kind == CacheKind::none) return;
    grid_.advance(backend_);
    run("resolve",
        ResolveCellsKernel{
            grid_.view(scene_.view().camera), view_of(pixels_), mutable_view_of(radiance_), layers_, width(), {}, {}});
  }

 private:
  uint32_t width() const { return static_cast<uint32_t>(settings_.width); }

  template <typename Cache>
  void trace_cells(const PathContext& context, const SampleIndex& index, const Cache& cache) {
    const CellsOutput<Cache> cells{cache, mutable_view_of(pixels_)};
    if (!settings_.watched) return trace(context, index, cells);
    first_vertices_.resize(pixels_.size());
    specular_.resize(pixels_.size());
    trace(context, index, FirstVertexOutput{mutable_view_of(first_vertices_)},
          SpecularOutput{mutable_view_of(specular_)}, cells);
  }

  template <typename... Outputs>
  void trace(const PathContext& context, const SampleIndex& index, const Outputs&... outputs) {
    run("trace", PathKernel<Outputs...>{
                     context, index, view_of(hits_), {}, mutable_view_of(rays_), width(), path_outputs(outputs...)});
  }

  template <typename Kernel>
  void run(const char* name, const Kernel& kernel) {
    launch(backend_, name, kernel, width(), static_cast<uint32_t>(settings_.height));
  }

  CachedFrameSettings settings_;
  CompiledScene scene_;
  Backend backend_;
  HashGrid grid_;
  std::vector<AliasEntry> power_;
  std::vector<Hit> hits_;
  std::vector<FilteredPixel> pixels_;
  std::vector<uint32_t> rays_;
  std::vector<Rgb> radiance_;
  std::vector<FirstVertex> first_vertices_;
  std::vector<Rgb> specular_;
  CellLayers layers_;
  uint32_t frame_ = 0;
};

}  // namespace relume::testing
