#include "techniques/transport/bdpt/testing/bdpt_frame.h"

#include <algorithm>
#include <utility>

#include "techniques/transport/bdpt/light_medium.h"

namespace relume::testing {

BdptFrame::BdptFrame(Scene scene, const BdptOptions& o)
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

BdptContext BdptFrame::context() {
  BdptContext c;
  c.path.scene = compiled.view();
  c.path.selector.kind = options.lights;
  c.path.selector.uniform = make_uniform_lights(compiled.view().lights);
  c.path.selector.power = {{view_of(power)}};
  c.path.max_bounces = options.max_bounces;
  c.path.russian_roulette = options.russian_roulette;
  c.path.first_nee_bounce = options.first_nee_bounce;
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

SampleIndex BdptFrame::find_hits(uint32_t seed, uint32_t sample) {
  const SampleIndex index{.seed = seed, .sample = sample, .frame = sample, .age = sample};
  const SceneView& view = compiled.view();
  launch(backend, "gbuffer", PrimaryHitsKernel{view, index, mutable_view_of(hits), {}, width()}, width(), height());
  return index;
}

void BdptFrame::run(uint32_t seed, uint32_t sample, uint32_t rows) {
  const SampleIndex index = find_hits(seed, sample);
  BdptKernel kernel{context(),
                    index,
                    view_of(hits),
                    view_of(allocation),
                    {mutable_view_of(radiance)},
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

void BdptFrame::trace_in_bands(BdptKernel kernel, uint32_t rows) {
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

std::vector<Rgb> render_bdpt(Scene scene, const BdptOptions& options, int spp, uint32_t seed) {
  BdptFrame frame(std::move(scene), options);
  std::vector<Rgb> image(frame.radiance.size(), Rgb(0));
  for (int i = 0; i < spp; ++i) {
    frame.run(seed, static_cast<uint32_t>(i));
    for (size_t p = 0; p < image.size(); ++p) image[p] += frame.radiance[p] / static_cast<float>(spp);
  }
  return image;
}

}  // namespace relume::testing
