#include <benchmark/benchmark.h>

#include <string_view>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Time of the filter of the caustic layer in frames of 1280 × 720 pixels on all threads.
void bm_caustic_layer(benchmark::State& state) {
  RenderSettings settings;
  settings.width = 1280;
  settings.height = 720;
  settings.path.max_bounces = 2;
  settings.estimator = EstimatorChoice::bdpt;
  settings.bdpt.caustic_layer = true;
  settings.denoise = DenoiseChoice::svgf;
  Session session(find_builtin_scene("cornell-water")->build(), settings);
  double before = 0;
  for (auto _ : state) {
    session.render_frame();
    double seconds = 0;
    for (const PassTime& pass : session.statistics().passes)
      seconds += std::string_view(pass.name).starts_with("caustics") ? pass.seconds : 0;
    state.SetIterationTime(seconds - before);
    before = seconds;
  }
}
BENCHMARK(bm_caustic_layer)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
