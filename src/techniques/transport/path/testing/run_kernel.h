// Runs the two kernels of a path in sequence, for tests that compare forms of the second.
#pragma once

#include <algorithm>
#include <vector>

#include "scene/compiled_scene.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/specular_part.h"

namespace relume::testing {

/// Finds the primary hits of width × height pixels and traces their paths, pixel by pixel (`tile_size` 0) or in tiles.
template <typename Kernel>
void run_kernel(const PrimaryHitsKernel& primary, const Kernel& kernel, uint32_t width, uint32_t height,
                uint32_t tile_size) {
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      primary(x, y);
      if (tile_size == 0) kernel(x, y);
    }
  }
  for (uint32_t y = 0; tile_size > 0 && y < height; y += tile_size) {
    for (uint32_t x = 0; x < width; x += tile_size)
      kernel(Tile{x, y, std::min(x + tile_size, width), std::min(y + tile_size, height)});
  }
}

struct TraceSettings {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t tile_size = 0;  ///< as for run_kernel()
  uint32_t max_bounces = PathContext{}.max_bounces;
  uint32_t sample = 3;
  uint32_t first_nee_bounce = 0;         ///< as in PathContext
  uint32_t light_candidates = 1;         ///< as in PathContext
  bool only_specular = false;            ///< as in PathContext
  View<const uint32_t> allocation = {};  ///< as for PathKernel
  bool russian_roulette = true;
};

/// Traces one sample per pixel with uniform light selection. Returns the number of rays per pixel.
template <typename... Outputs>
std::vector<uint32_t> trace_pixels(const CompiledScene& scene, const TraceSettings& settings,
                                   const Outputs&... outputs) {
  const SceneView view = scene.view();
  const SampleIndex index{.seed = 7, .sample = settings.sample};
  std::vector<Hit> hits(size_t{settings.width} * settings.height);
  std::vector<uint32_t> rays(hits.size());
  const PrimaryHitsKernel primary{view, index, mutable_view_of(hits), {}, settings.width};
  PathKernel<Outputs...> kernel;
  kernel.context.scene = view;
  kernel.context.selector.kind = LightSelectorKind::uniform;
  kernel.context.selector.uniform = make_uniform_lights(view.lights);
  kernel.context.max_bounces = settings.max_bounces;
  kernel.context.first_nee_bounce = settings.first_nee_bounce;
  kernel.context.light_candidates = settings.light_candidates;
  kernel.context.only_specular = settings.only_specular;
  kernel.context.russian_roulette = settings.russian_roulette;
  kernel.index = index;
  kernel.hits = view_of(hits);
  kernel.allocation = settings.allocation;
  kernel.rays = mutable_view_of(rays);
  kernel.width = settings.width;
  kernel.outputs = path_outputs(outputs...);
  run_kernel(primary, kernel, settings.width, settings.height, settings.tile_size);
  return rays;
}

// Kernels take long to compile: run_kernel.cpp contains those of several tests.
extern template std::vector<uint32_t> trace_pixels(const CompiledScene&, const TraceSettings&, const RadianceOutput&);
extern template std::vector<uint32_t> trace_pixels(const CompiledScene&, const TraceSettings&, const RadianceOutput&,
                                                   const FirstVertexOutput&);
extern template std::vector<uint32_t> trace_pixels(const CompiledScene&, const TraceSettings&, const RadianceOutput&,
                                                   const SpecularOutput&);

}  // namespace relume::testing
