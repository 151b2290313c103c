#include <benchmark/benchmark.h>

#include <vector>

#include "frame/launch.h"
#include "framebuffer/testing/moment_vectors.h"
#include "techniques/temporal/adaptive_sampling/paper_allocation.h"
#include "techniques/temporal/adaptive_sampling/pooled_deviation.h"

namespace relume {
namespace {

void bm_paper_allocation(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const testing::MomentVectors history(kWidth * kHeight, {Rgb(0.5f), 1.5f, 4.5f, 9});
  std::vector<float> probability(kWidth * kHeight, 0.0f);
  std::vector<float> noise(kWidth * kHeight, 0.0f);
  std::vector<uint32_t> allocation(kWidth * kHeight, 0);
  PaperAllocationKernel kernel;
  kernel.history = history.view();
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
  const testing::MomentVectors history(kWidth * kHeight, {Rgb(0.5f), 1.5f, 4.5f, 9});
  std::vector<PooledMoments> moments(kWidth * kHeight);
  std::vector<PooledMoments> rows(kWidth * kHeight);
  std::vector<float> deviation(kWidth * kHeight);
  const OwnStatisticsKernel own{history.view(), mutable_view_of(moments), kWidth};
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
