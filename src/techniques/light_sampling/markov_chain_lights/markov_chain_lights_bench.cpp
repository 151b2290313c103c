// Frames of one sample per pixel on one thread, with filled tables, among many lamps.
#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

void bm_light_chains(benchmark::State& state, LightSelectionChoice lights) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.lights = lights;
  settings.path.max_bounces = 2;
  Session session(find_builtin_scene("warehouse")->build(), settings);
  for (int i = 0; i < 16; ++i) session.render_frame();
  for (auto _ : state) session.render_frame();
  state.SetItemsProcessed(state.iterations() * settings.width * settings.height);
}
BENCHMARK_CAPTURE(bm_light_chains, light_tree, LightSelectionChoice::light_tree)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_light_chains, vlc, LightSelectionChoice::vlc)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_light_chains, mcls, LightSelectionChoice::mcls)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
