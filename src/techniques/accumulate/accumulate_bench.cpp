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
  const std::vector<uint32_t> frame_rays(radiance.size(), 5);
  std::vector<uint32_t> rays(radiance.size(), 0);
  std::vector<uint32_t> nonfinite(radiance.size(), 0);
  const AccumulateKernel kernel{view_of(radiance),
                                view_of(frame_rays),
                                mutable_view_of(sum),
                                mutable_view_of(squares),
                                mutable_view_of(rays),
                                mutable_view_of(nonfinite),
                                kWidth};
  Backend backend(1);
  for (auto _ : state) launch(backend, "accumulate", kernel, kWidth, kHeight);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_accumulate);

}  // namespace
}  // namespace relume
