#include <benchmark/benchmark.h>

#include <string>

#include "render/session.h"
#include "scene/builtin.h"

namespace relume {
namespace {

/// The denoiser on frames of 1280 × 720 pixels, without what they cost otherwise; on as many threads as there are.
void bm_svgf(benchmark::State& state) {
  RenderSettings settings;
  settings.width = 1280;
  settings.height = 720;
  settings.path.max_bounces = 1;
  settings.denoise = DenoiseChoice::svgf;
  Session session(find_builtin_scene("cornell")->build(), settings);
  double before = 0;
  for (auto _ : state) {
    session.render_frame();
    double seconds = 0;
    for (const PassTime& pass : session.statistics().passes)
      seconds += pass.name.starts_with("svgf") ? pass.seconds : 0;
    state.SetIterationTime(seconds - before);
    before = seconds;
  }
}
BENCHMARK(bm_svgf)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
