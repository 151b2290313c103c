// Runs the kernels of bidirectional path tracing without a session, to give tests access to every buffer.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "frame/launch.h"
#include "scene/compiled_scene.h"
#include "techniques/transport/bdpt/bdpt.h"
#include "techniques/transport/bdpt/light_medium.h"

namespace relume::testing {

struct BdptOptions {
  int width = 16;
  int height = 16;
  uint32_t max_bounces = 8;
  bool russian_roulette = true;
  bool light_only = false;
  uint32_t max_light_vertices = 16;
  float connection_roulette = 0;
  LightSelectorKind lights = LightSelectorKind::power;
  int threads = 1;
  std::vector<Index> movable = {};  ///< CompileOptions::movable
};

/// A compiled scene and the buffers of one frame.
class BdptFrame {
 public:
  BdptFrame(Scene scene, const BdptOptions& o)
      : options(o),
        compiled(std::move(scene), {.camera = {}, .width = o.width, .height = o.height, .movable = o.movable}),
        backend(o.threads) {
    const LightsView& lights = compiled.view().lights;
    power = build_power_lights(lights);
    emission = build_power_lights(lights, o.light_only ? LightsAtInfinity::all : LightsAtInfinity::worth_sampling);
    if (compiled.view().absorbs) light_medium.resize(lights.lights.size);
    launch(backend, "lights", LightMediumKernel{compiled.view(), mutable_view_of(light_medium)},
           static_cast<uint32_t>(light_medium.size()), 1);
    const auto pixels = static_cast<size_t>(o.width) * static_cast<size_t>(o.height);
    hits.resize(pixels);
    radiance.resize(pixels);
    rays.resize(pixels);
    splats.resize(pixels);
  }

  BdptContext context() {
    BdptContext c;
    c.path.scene = compiled.view();
    c.path.selector.kind = options.lights;
    c.path.selector.uniform = make_uniform_lights(compiled.view().lights);
    c.path.selector.power = {{view_of(power)}};
    c.path.max_bounces = options.max_bounces;
    c.path.russian_roulette = options.russian_roulette;
    c.emission = {{view_of(emission)}};
    c.connection = {{view_of(power)}};
    c.light_medium = view_of(light_medium);
    c.splats = mutable_view_of(splats);
    c.width = width();
    c.max_light_vertices = options.max_light_vertices;
    c.connection_roulette = options.connection_roulette;
    c.light_only = options.light_only;
    return c;
  }

  /// Traces sample `sample` of every pixel. `rows`: of the bands in which threads with little memory trace them; 0: the
  /// host traces tiles.
  void run(uint32_t seed, uint32_t sample, uint32_t rows = 0) {
    const SampleIndex index{.seed = seed, .sample = sample, .frame = sample, .age = sample};
    const SceneView& view = compiled.view();
    launch(backend, "gbuffer", PrimaryHitsKernel{view, index, mutable_view_of(hits), {}, width()}, width(), height());
    BdptKernel kernel{context(),
                      index,
                      view_of(hits),
                      view_of(allocation),
                      mutable_view_of(radiance),
                      mutable_view_of(rays),
                      {&saturated, 1},
                      {&nonfinite, 1}};
    if (rows == 0) {
      launch(backend, "trace", kernel, width(), height());
    } else {
      trace_in_bands(kernel, rows);
    }
    launch(backend, "splats", AddSplatsKernel{mutable_view_of(splats), mutable_view_of(radiance), {}, 1.0f, width()},
           width(), height());
  }

  void trace_in_bands(BdptKernel kernel, uint32_t rows) {
    const size_t size = size_t{kernel.context.max_kept_vertices()} * width() * rows;
    std::vector<PathVertex> vertices(size);
    std::vector<CameraConnection> to_camera(size);
    kernel.vertices = mutable_view_of(vertices);
    kernel.to_camera = mutable_view_of(to_camera);
    kernel.kept_rows = rows;
    backend.configure(options.threads, KernelForm::device);
    for (uint32_t y = 0; y < height(); y += rows)
      launch(backend, "trace", kernel, Tile{0, y, width(), std::min(y + rows, height())});
    backend.configure(options.threads, KernelForm::host);
  }

  uint32_t width() const { return static_cast<uint32_t>(options.width); }
  uint32_t height() const { return static_cast<uint32_t>(options.height); }

  BdptOptions options;
  CompiledScene compiled;
  Backend backend;
  std::vector<AliasEntry> power;
  std::vector<AliasEntry> emission;
  std::vector<Rgb> light_medium;
  std::vector<Hit> hits;
  std::vector<uint32_t> allocation;  ///< empty: one path per pixel
  std::vector<Rgb> radiance;
  std::vector<uint32_t> rays;
  std::vector<FixedPointRgb> splats;
  uint64_t saturated = 0;
  uint64_t nonfinite = 0;
};

/// Mean of `spp` samples per pixel.
inline std::vector<Rgb> render_bdpt(Scene scene, const BdptOptions& options, int spp, uint32_t seed = 0) {
  BdptFrame frame(std::move(scene), options);
  std::vector<Rgb> image(frame.radiance.size(), Rgb(0));
  for (int i = 0; i < spp; ++i) {
    frame.run(seed, static_cast<uint32_t>(i));
    for (size_t p = 0; p < image.size(); ++p) image[p] += frame.radiance[p] / static_cast<float>(spp);
  }
  return image;
}

}  // namespace relume::testing
