// One frame of one sample per pixel on one thread: path tracing, and path space filtering.
#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

void bm_filtered_frame(benchmark::State& state, const char* scene, testing::CacheKind kind) {
  testing::CachedFrameSettings settings;
  settings.kind = kind;
  settings.width = settings.height = 128;
  settings.max_bounces = 6;
  testing::CachedFrames frames(find_builtin_scene(scene)->build(), settings);
  frames.render();
  for (auto _ : state) frames.render();
  if (frames.grid().statistics().dropped > 0) state.SkipWithError("samples were dropped");
  state.SetItemsProcessed(state.iterations() * settings.width * settings.height);
  for (const LaunchTime& t : frames.backend().times())
    state.counters[t.name] = t.seconds / static_cast<double>(t.launches);
}
BENCHMARK_CAPTURE(bm_filtered_frame, cornell_none, "cornell", testing::CacheKind::none)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_filtered_frame, cornell_psf, "cornell", testing::CacheKind::psf)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
