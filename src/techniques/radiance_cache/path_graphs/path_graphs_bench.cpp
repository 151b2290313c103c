// One frame of one sample per pixel on one thread, with filled cells. The argument is apg.feed in per cent.
#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

void bm_path_graph_frame(benchmark::State& state) {
  testing::CachedFrameSettings settings;
  settings.kind = testing::CacheKind::apg;
  settings.width = settings.height = 128;
  settings.max_bounces = 6;
  settings.apg.feed = static_cast<float>(state.range(0)) * 0.01f;
  testing::CachedFrames frames(find_builtin_scene("cornell")->build(), settings);
  for (int i = 0; i < 8; ++i) frames.render();
  uint64_t rays = 0;
  for (auto _ : state) {
    frames.render();
    rays += frames.rays();
  }
  if (rays == 0) state.SkipWithError("no ray was traced");
  const auto pixels = static_cast<double>(state.iterations() * settings.width * settings.height);
  state.SetItemsProcessed(static_cast<int64_t>(pixels));
  state.counters["rays/pixel"] = static_cast<double>(rays) / pixels;
}
BENCHMARK(bm_path_graph_frame)->Arg(0)->Arg(25)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
