#include <benchmark/benchmark.h>

#include <vector>

#include "frame/launch.h"
#include "framebuffer/testing/moment_vectors.h"
#include "techniques/temporal/accumulate/accumulate.h"

namespace relume {
namespace {

void bm_accumulate(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const std::vector<Rgb> radiance(kWidth * kHeight, Rgb(0.5f));
  testing::MomentVectors moments(radiance.size());
  const std::vector<uint32_t> frame_rays(radiance.size(), 5);
  std::vector<uint32_t> rays(radiance.size(), 0);
  std::vector<uint32_t> nonfinite(radiance.size(), 0);
  AccumulateKernel kernel;
  kernel.radiance = view_of(radiance);
  kernel.rays = view_of(frame_rays);
  kernel.history = moments.view();
  kernel.moments = moments.mutable_view();
  kernel.ray_sum = mutable_view_of(rays);
  kernel.nonfinite = mutable_view_of(nonfinite);
  kernel.width = kWidth;
  Backend backend(1);
  for (auto _ : state) launch(backend, "accumulate", kernel, kWidth, kHeight);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_accumulate);

}  // namespace
}  // namespace relume
