#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Time of the features pass alone, on one thread. A hook makes it evaluate the surfaces itself.
void bm_features(benchmark::State& state, const char* scene) {
  RenderSettings settings;
  settings.width = settings.height = 256;
  settings.threads = 1;
  settings.denoise = DenoiseChoice::svgf;
  Session session(find_builtin_scene(scene)->build(), settings);
  session.on_pass([](const std::string&) {});
  double before = 0;
  for (auto _ : state) {
    session.render_frame();
    double seconds = 0;
    for (const PassTime& pass : session.statistics().passes) seconds += pass.name == "features" ? pass.seconds : 0;
    state.SetIterationTime(seconds - before);
    before = seconds;
  }
  state.SetItemsProcessed(state.iterations() * settings.width * settings.height);
}
BENCHMARK_CAPTURE(bm_features, cornell, "cornell")->Unit(benchmark::kMillisecond)->UseManualTime();
BENCHMARK_CAPTURE(bm_features, mirror, "cornell-mirror")->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
