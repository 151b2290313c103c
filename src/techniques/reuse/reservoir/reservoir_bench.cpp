#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/reuse/reservoir/testing/reuse_toy.h"

namespace relume {
namespace {

void bm_reservoir_pairwise(benchmark::State& state) {
  testing::Random random(1);
  constexpr uint32_t kNeighbours = 4;
  for (auto _ : state) {
    Reservoir<uint32_t> own{1, 1, random.next(), 20};
    PairwiseCombination<uint32_t> combination(own, kNeighbours);
    for (uint32_t i = 0; i < kNeighbours; ++i)
      combination.add({i, 1, random.next(), 20}, random.next(), random.next(), random.next());
    benchmark::DoNotOptimize(combination.finish(random.next()));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(bm_reservoir_pairwise);

/// Frames of one sample per pixel on one thread.
void bm_ris(benchmark::State& state, const char* scene) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.reuse = ReuseChoice::ris;
  Session session(find_builtin_scene(scene)->build(), settings);
  for (auto _ : state) session.render_frame();
  const Statistics& s = session.statistics();
  state.SetItemsProcessed(static_cast<int64_t>(s.samples));
  state.counters["rays/sample"] = static_cast<double>(s.rays) / static_cast<double>(s.samples);
}
BENCHMARK_CAPTURE(bm_ris, cornell, "cornell")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_ris, warehouse, "warehouse")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
