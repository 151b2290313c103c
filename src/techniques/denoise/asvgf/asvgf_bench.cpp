#include <benchmark/benchmark.h>

#include <string_view>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Time of the gradients in frames of 1280 × 720 pixels on all threads. Argument: whether lamps move, which traces
/// them.
void bm_asvgf(benchmark::State& state) {
  const bool moving = state.range(0) != 0;
  RenderSettings settings;
  settings.width = 1280;
  settings.height = 720;
  settings.denoise = DenoiseChoice::asvgf;
  Session session(find_builtin_scene("turntable")->build(), settings);
  session.render_frame();
  const auto seconds_so_far = [&session] {
    double seconds = 0;
    for (const PassTime& pass : session.statistics().passes)
      seconds += std::string_view(pass.name).starts_with("asvgf") ? pass.seconds : 0;
    return seconds;
  };
  double before = seconds_so_far();
  int frame = 0;
  for (auto _ : state) {
    if (moving) session.set_time(0.02f * static_cast<float>(++frame));
    session.render_frame();
    const double now = seconds_so_far();
    state.SetIterationTime(now - before);
    before = now;
  }
}
BENCHMARK(bm_asvgf)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
