#include <benchmark/benchmark.h>

#include <vector>

#include "backend/launch.h"
#include "techniques/accumulate/accumulate.h"

namespace relume {
namespace {

void bm_accumulate(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const std::vector<Rgb> radiance(kWidth * kHeight, Rgb(0.5f));
  std::vector<Rgb> sum(radiance.size(), Rgb(0));
  std::vector<float> squares(radiance.size(), 0.0f);
  const AccumulateKernel kernel{view_of(radiance), mutable_view_of(sum), mutable_view_of(squares), kWidth};
  Backend backend(1);
  for (auto _ : state) launch(backend, "accumulate", kernel, kWidth, kHeight);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_accumulate);

}  // namespace
}  // namespace relume
