#include <benchmark/benchmark.h>

#include <vector>

#include "sampling/alias_table.h"
#include "sampling/distribution_2d.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace relume {
namespace {

void bm_sampler_1d(benchmark::State& state) {
  uint32_t sample = 0;
  for (auto _ : state) {
    Sampler sampler = Sampler::sequence(1, 2, 3, sample++);
    benchmark::DoNotOptimize(sampler.next_1d());
  }
}
BENCHMARK(bm_sampler_1d);

void bm_sampler_2d(benchmark::State& state) {
  uint32_t sample = 0;
  for (auto _ : state) {
    Sampler sampler = Sampler::sequence(1, 2, 3, sample++);
    benchmark::DoNotOptimize(sampler.next_2d());
  }
}
BENCHMARK(bm_sampler_2d);

template <typename Warp>
void run_warp(benchmark::State& state, const Warp& warp) {
  uint32_t i = 0;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;  // cheaper than the warp that is measured
    benchmark::DoNotOptimize(warp(Vec2(to_unit_float(i), to_unit_float(i << 8))));
  }
}

void bm_disk(benchmark::State& state) { run_warp(state, disk_from_square); }
BENCHMARK(bm_disk);
void bm_cosine_hemisphere(benchmark::State& state) { run_warp(state, cosine_hemisphere_from_square); }
BENCHMARK(bm_cosine_hemisphere);
void bm_sphere(benchmark::State& state) { run_warp(state, sphere_from_square); }
BENCHMARK(bm_sphere);
void bm_cone(benchmark::State& state) {
  run_warp(state, [](const Vec2& u) { return cone_from_square(u, 1e-5f); });
}
BENCHMARK(bm_cone);
void bm_triangle(benchmark::State& state) { run_warp(state, triangle_from_square); }
BENCHMARK(bm_triangle);

std::vector<float> some_weights(uint32_t count) {
  std::vector<float> weights;
  for (uint32_t i = 0; i < count; ++i) weights.push_back(sqr(to_unit_float(hash(i))));
  return weights;
}

void bm_alias_table(benchmark::State& state) {
  const auto entries = build_alias_table(some_weights(static_cast<uint32_t>(state.range(0))));
  const AliasTable table{view_of(entries)};
  run_warp(state, [&](const Vec2& u) { return table.sample({u.x, float_bits(u.y)}); });
}
BENCHMARK(bm_alias_table)->Arg(100)->Arg(1'000'000);

void bm_build_alias_table(benchmark::State& state) {
  const auto weights = some_weights(static_cast<uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(build_alias_table(weights));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(bm_build_alias_table)->Arg(10'000);

void bm_distribution_2d(benchmark::State& state) {
  const auto storage = build_distribution_2d(some_weights(1024 * 512), 1024, 512);
  const Distribution2D distribution = storage.view();
  run_warp(state, [&](const Vec2& u) { return distribution.sample(u); });
}
BENCHMARK(bm_distribution_2d);

}  // namespace
}  // namespace relume
