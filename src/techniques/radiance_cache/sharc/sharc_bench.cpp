// One frame of one sample per pixel on one thread, with filled cells. Argument: edge of a block with one update path.
#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/sharc/testing/sharc_sessions.h"

namespace relume {
namespace {

void bm_sharc_frame(benchmark::State& state) {
  RenderSettings settings = testing::sharc_settings(128, 128);
  settings.path.max_bounces = 6;
  settings.sharc.update = state.range(0) == 1 ? SharcUpdate::all : SharcUpdate::sparse;
  Session session(find_builtin_scene("cornell")->build(), settings);
  testing::skip_frames(session, 16);
  const uint64_t before = session.statistics().rays;
  for (auto _ : state) session.render_frame();
  const auto pixels = static_cast<double>(state.iterations() * settings.width * settings.height);
  state.SetItemsProcessed(static_cast<int64_t>(pixels));
  state.counters["rays/pixel"] = static_cast<double>(session.statistics().rays - before) / pixels;
}
BENCHMARK(bm_sharc_frame)->Arg(5)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
