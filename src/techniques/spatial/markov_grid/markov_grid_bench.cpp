// Draws the cells of vertices, and gives records to their cells.
#include <benchmark/benchmark.h>

#include <vector>

#include "techniques/spatial/markov_grid/markov_records.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

struct Number {
  uint32_t value = 0;
  float weight = 0;
};

void bm_markov_draw(benchmark::State& state) {
  const testing::FilledTable<Number> table;
  SurfacePoint sp = testing::point_at({1, 0.3f, -2}, {0, 1, 0});
  for (auto _ : state) {
    sp.position.x += 1e-3f;
    const uint32_t seed = table.grid.seed_at(sp);
    for (uint32_t i = 0; i < table.grid.drawn_cells; ++i)
      benchmark::DoNotOptimize(table.view().load(table.grid.drawn(sp, seed, i)));
  }
}
BENCHMARK(bm_markov_draw);

void bm_markov_write(benchmark::State& state) {
  constexpr uint32_t kRecords = 1u << 16;
  testing::FilledTable<Number> table;
  std::vector<uint64_t> winners(table.slots.size(), MarkovPriority::kNone);
  std::vector<MarkovRecord<Number>> records(kRecords);
  for (uint32_t i = 0; i < kRecords; ++i) {
    for (uint32_t k = 0; k < 2; ++k)
      records[i].cells[k] = {hash(i, k) % static_cast<uint32_t>(table.slots.size()), hash(k, i)};
  }
  MarkovPriority priority;
  for (auto _ : state) {
    priority.stamp = priority.stamp % MarkovPriority::kMostStamp + 1;
    const ElectWritersKernel<Number> elect{view_of(records), mutable_view_of(winners), priority};
    for (uint32_t i = 0; i < kRecords; ++i) elect(i, 0);
    const WriteStatesKernel<Number> write{view_of(records), view_of(winners), mutable_view_of(table.slots), priority};
    for (uint32_t i = 0; i < kRecords; ++i) write(i, 0);
  }
  state.SetItemsProcessed(state.iterations() * kRecords);
}
BENCHMARK(bm_markov_write)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
