#include <benchmark/benchmark.h>

#include "core/hash.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/group_by_key.h"
#include "frame/primitives/reduce.h"
#include "frame/primitives/scan.h"

namespace relume {
namespace {

/// Random numbers below `below`.
Array<uint32_t> random_words(uint32_t size, uint32_t below) {
  Array<uint32_t> values;
  values.reset(size, kUninitialized);
  uint32_t i = 0;
  for (uint32_t& value : values.write()) value = hash(i++) % below;
  return values;
}

/// A backend with a thread per core, and the memory of the primitives that run on it.
struct Bench {
  Backend backend;
  PrimitiveScratch scratch;

  PrimitiveLaunch at() { return {backend, "bench", scratch}; }
};

uint32_t size_of(const benchmark::State& state) { return static_cast<uint32_t>(state.range(0)); }

void bm_sum_of_counts(benchmark::State& state) {
  Bench bench;
  const Array<uint32_t> values = random_words(size_of(state), 5);
  for (auto _ : state) benchmark::DoNotOptimize(sum(bench.at(), values.view()));
}
BENCHMARK(bm_sum_of_counts)->ArgName("elements")->Arg(10'000)->Arg(100'000)->Arg(2'000'000)->UseRealTime();

void bm_sum_of_reals(benchmark::State& state) {
  Bench bench;
  Array<float> values;
  values.assign(size_of(state), 0.1f);
  const Elements<float> input{values.view()};
  for (auto _ : state) benchmark::DoNotOptimize(reduce<Sum<double>>(bench.at(), input, values.view().size));
}
BENCHMARK(bm_sum_of_reals)->ArgName("elements")->Arg(100'000)->Arg(2'000'000)->UseRealTime();

void bm_exclusive_scan(benchmark::State& state) {
  Bench bench;
  const Array<uint32_t> values = random_words(size_of(state), 5);
  Array<uint32_t> sums = values;
  const Elements<uint32_t> input{values.view()};
  for (auto _ : state) benchmark::DoNotOptimize(exclusive_scan(bench.at(), input, sums.mutable_view()));
}
BENCHMARK(bm_exclusive_scan)->ArgName("elements")->Arg(10'000)->Arg(100'000)->Arg(2'000'000)->UseRealTime();

void bm_group_by_key(benchmark::State& state) {
  Bench bench;
  const auto key_count = static_cast<uint32_t>(state.range(1));
  const Array<uint32_t> keys = random_words(size_of(state), key_count);
  const Elements<uint32_t> input{keys.view()};
  KeyGroups groups;
  for (auto _ : state) group_by_key(bench.at(), input, keys.view().size, key_count, groups);
}
BENCHMARK(bm_group_by_key)
    ->ArgNames({"elements", "keys"})
    ->Args({100'000, 1000})
    ->Args({2'000'000, 1000})
    ->Args({2'000'000, 20'000})
    ->UseRealTime();

void bm_fill(benchmark::State& state) {
  Bench bench;
  Array<uint32_t> values = random_words(size_of(state), 5);
  for (auto _ : state) fill(bench.backend, "bench", values.mutable_view(), 1u);
}
BENCHMARK(bm_fill)->ArgName("elements")->Arg(100'000)->Arg(2'000'000)->UseRealTime();

}  // namespace
}  // namespace relume
