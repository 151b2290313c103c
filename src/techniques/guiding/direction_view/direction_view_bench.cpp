#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// The view in frames of 256 × 128 pixels, with 128 × 128 directions per map.
void bm_direction_view(benchmark::State& state) {
  RenderSettings settings;
  settings.width = 256;
  settings.height = 128;
  settings.guide = GuideChoice::cdq;
  settings.cdq.view = true;
  Session session(find_builtin_scene("cornell")->build(), settings);
  double before = 0;
  for (auto _ : state) {
    session.render_frame();
    double seconds = 0;
    for (const PassTime& pass : session.statistics().passes) seconds += pass.name == "cdq-view" ? pass.seconds : 0;
    state.SetIterationTime(seconds - before);
    before = seconds;
  }
}
BENCHMARK(bm_direction_view)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
