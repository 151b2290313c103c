#include <benchmark/benchmark.h>

#include <vector>

#include "frame/launch.h"
#include "techniques/temporal/upscaling/upscaling.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 640;
constexpr uint32_t kHeight = 360;

void bm_fill_unsampled(benchmark::State& state) {
  const std::vector<Rgb> color(kWidth * kHeight, Rgb(0.5f));
  std::vector<uint32_t> samples(kWidth * kHeight);
  std::vector<Rgb> filled(kWidth * kHeight);
  Backend backend(1);
  launch(backend, "allocate", BlockAllocationKernel{mutable_view_of(samples), {}, 2, kWidth}, kWidth, kHeight);
  const FillUnsampledKernel kernel{view_of(color), view_of(samples), mutable_view_of(filled), 2, kWidth, kHeight};
  for (auto _ : state) launch(backend, "fill", kernel, kWidth, kHeight);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_fill_unsampled);

}  // namespace
}  // namespace relume
