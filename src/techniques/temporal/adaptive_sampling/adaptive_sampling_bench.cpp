#include <benchmark/benchmark.h>

#include <vector>

#include "frame/launch.h"
#include "techniques/temporal/adaptive_sampling/paper_allocation.h"
#include "techniques/temporal/adaptive_sampling/pooled_deviation.h"

namespace relume {
namespace {

void bm_paper_allocation(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const std::vector<Rgb> mean(kWidth * kHeight, Rgb(0.5f));
  const std::vector<Rgb> m2(mean.size(), Rgb(1.5f));
  const std::vector<uint32_t> samples(mean.size(), 9);
  std::vector<float> probability(mean.size(), 0.0f);
  std::vector<float> noise(mean.size(), 0.0f);
  std::vector<uint32_t> allocation(mean.size(), 0);
  PaperAllocationKernel kernel;
  kernel.mean = view_of(mean);
  kernel.m2 = view_of(m2);
  kernel.samples = view_of(samples);
  kernel.probability = mutable_view_of(probability);
  kernel.noise = mutable_view_of(noise);
  kernel.allocation = mutable_view_of(allocation);
  kernel.iteration = 12;
  kernel.width = kWidth;
  Backend backend(1);
  for (auto _ : state) launch(backend, "allocate", kernel, kWidth, kHeight);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_paper_allocation);

void bm_pooled_deviation(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const std::vector<Rgb> mean(kWidth * kHeight, Rgb(0.5f));
  const std::vector<float> m2(mean.size(), 1.5f);
  const std::vector<uint32_t> samples(mean.size(), 9);
  std::vector<PooledMoments> moments(mean.size());
  std::vector<PooledMoments> rows(mean.size());
  std::vector<float> deviation(mean.size());
  const PixelMomentsKernel own{view_of(mean), view_of(m2), view_of(samples), mutable_view_of(moments), kWidth};
  const PoolRowsKernel along_rows{view_of(moments), mutable_view_of(rows), kWidth};
  const PooledDeviationKernel pool{view_of(moments), view_of(rows), mutable_view_of(deviation), kWidth, kHeight};
  Backend backend(1);
  for (auto _ : state) {
    launch(backend, "moments", own, kWidth, kHeight);
    launch(backend, "rows", along_rows, kWidth, kHeight);
    launch(backend, "deviation", pool, kWidth, kHeight);
  }
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_pooled_deviation);

}  // namespace
}  // namespace relume
