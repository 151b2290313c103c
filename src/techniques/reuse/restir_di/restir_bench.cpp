#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Frames of one sample per pixel on one thread.
void bm_restir_di(benchmark::State& state, const char* scene, ReuseCorrection correction) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.reuse = ReuseChoice::restir_di;
  settings.restir.correction = correction;
  Session session(find_builtin_scene(scene)->build(), settings);
  for (auto _ : state) session.render_frame();
  const Statistics& s = session.statistics();
  state.SetItemsProcessed(static_cast<int64_t>(s.samples));
  state.counters["rays/sample"] = static_cast<double>(s.rays) / static_cast<double>(s.samples);
}
BENCHMARK_CAPTURE(bm_restir_di, cornell_exact, "cornell", ReuseCorrection::exact)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_di, cornell_basic, "cornell", ReuseCorrection::basic)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_di, warehouse_exact, "warehouse", ReuseCorrection::exact)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
