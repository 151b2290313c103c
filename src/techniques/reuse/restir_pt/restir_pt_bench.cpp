#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Frames of one sample per pixel on one thread.
void bm_restir_pt(benchmark::State& state, const char* scene, ReuseChoice reuse, PathShiftKind shift,
                  PathCorrection correction, bool reciprocal = false) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.restir_pt.shift = shift;
  settings.restir_pt.correction = correction;
  settings.restir_pt.reciprocal = reciprocal;
  Session session(find_builtin_scene(scene)->build(), settings);
  for (auto _ : state) session.render_frame();
  const Statistics& s = session.statistics();
  state.SetItemsProcessed(static_cast<int64_t>(s.samples));
  state.counters["rays/sample"] = static_cast<double>(s.rays) / static_cast<double>(s.samples);
}
BENCHMARK_CAPTURE(bm_restir_pt, cornell_path, "cornell", ReuseChoice::none, PathShiftKind::hybrid,
                  PathCorrection::exact)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_pt, cornell_hybrid, "cornell", ReuseChoice::restir_pt, PathShiftKind::hybrid,
                  PathCorrection::exact)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_pt, cornell_reciprocal, "cornell", ReuseChoice::restir_pt, PathShiftKind::hybrid,
                  PathCorrection::exact, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_pt, cornell_reconnection, "cornell", ReuseChoice::restir_pt, PathShiftKind::reconnection,
                  PathCorrection::exact)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_pt, cornell_constant, "cornell", ReuseChoice::restir_pt, PathShiftKind::hybrid,
                  PathCorrection::constant)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_restir_pt, corridor_hybrid, "corridor", ReuseChoice::restir_pt, PathShiftKind::hybrid,
                  PathCorrection::exact)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
