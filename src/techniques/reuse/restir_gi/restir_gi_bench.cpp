#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Frames of one sample per pixel on one thread.
void bm_restir_gi(benchmark::State& state, const char* scene, ReuseChoice reuse, ReuseCorrection correction) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.restir_gi.correction = correction;
  Session session(find_builtin_scene(scene)->build(), settings);
  for (auto _ : state) session.render_frame();
  const Statistics& s = session.statistics();
  state.SetItemsProcessed(static_cast<int64_t>(s.samples));
  state.counters["rays/sample"] = static_cast<double>(s.rays) / static_cast<double>(s.samples);
}
BENCHMARK_CAPTURE(bm_restir_gi, cornell_path, "cornell", ReuseChoice::none, ReuseCorrection::exact)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_gi, cornell_exact, "cornell", ReuseChoice::restir_gi, ReuseCorrection::exact)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_gi, cornell_lagging, "cornell", ReuseChoice::restir_gi, ReuseCorrection::lagging)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_gi, cornell_basic, "cornell", ReuseChoice::restir_gi, ReuseCorrection::basic)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_gi, cornell_with_di, "cornell", ReuseChoice::restir_di_gi, ReuseCorrection::exact)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_gi, corridor_exact, "corridor", ReuseChoice::restir_gi, ReuseCorrection::exact)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
