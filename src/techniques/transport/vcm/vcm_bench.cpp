#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Renders frames of one sample per pixel on one thread. bm_bdpt has the same scenes without merging.
void bm_vcm(benchmark::State& state, const char* name) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.estimator = EstimatorChoice::vcm;
  Session session(find_builtin_scene(name)->build(), settings);
  for (auto _ : state) session.render_frame();
  const Statistics& s = session.statistics();
  if (s.nonfinite_samples > 0) state.SkipWithError("samples that are not finite");
  state.SetItemsProcessed(static_cast<int64_t>(s.samples));
  state.counters["rays/sample"] = static_cast<double>(s.rays) / static_cast<double>(s.samples);
}
BENCHMARK_CAPTURE(bm_vcm, cornell, "cornell")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_vcm, cornell_glass, "cornell-glass")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
