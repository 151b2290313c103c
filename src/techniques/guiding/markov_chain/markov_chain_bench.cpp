#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/guiding/markov_chain/markov_guide.h"
#include "techniques/guiding/markov_chain/testing/random_states.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

/// The lobes of a vertex, and their density.
void bm_markov_lobes(benchmark::State& state) {
  testing::FilledTable<GuideState> table;
  const SurfacePoint sp = testing::point_at({1, 0.3f, -2}, {0, 1, 0});
  table.fill(sp, [](uint32_t number) { return testing::random_state(number); });
  const MarkovGuide guide{.grid = table.grid, .table = table.view()};
  for (auto _ : state) {
    MarkovLobes lobes;
    guide.add_lobes(sp, lobes);
    benchmark::DoNotOptimize(lobes.pdf(sp.frame.n));
  }
}
BENCHMARK(bm_markov_lobes);

/// Frames of one sample per pixel on one thread, with filled tables.
void bm_markov_frame(benchmark::State& state, GuideChoice guide, bool nee) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  settings.guide = guide;
  settings.mcpg.nee = nee;
  Session session(find_builtin_scene("cornell")->build(), settings);
  for (int i = 0; i < 16; ++i) session.render_frame();
  const uint64_t before = session.statistics().rays;
  for (auto _ : state) session.render_frame();
  const auto pixels = static_cast<double>(state.iterations() * settings.width * settings.height);
  state.SetItemsProcessed(static_cast<int64_t>(pixels));
  state.counters["rays/pixel"] = static_cast<double>(session.statistics().rays - before) / pixels;
}
BENCHMARK_CAPTURE(bm_markov_frame, bsdf, GuideChoice::bsdf, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_markov_frame, cdq, GuideChoice::cdq, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_markov_frame, mcpg, GuideChoice::mcpg, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_markov_frame, mcpg_without_nee, GuideChoice::mcpg, false)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
