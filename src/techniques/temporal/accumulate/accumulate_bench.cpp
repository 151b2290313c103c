#include <benchmark/benchmark.h>

#include <vector>

#include "frame/launch.h"
#include "framebuffer/testing/moment_vectors.h"
#include "techniques/temporal/accumulate/accumulate.h"
#include "techniques/temporal/accumulate/sample_sums.h"

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

void bm_sample_sums(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const std::vector<Rgb> radiance(kWidth * kHeight, Rgb(0.5f));
  std::vector<SampleBlock> blocks(radiance.size());
  std::vector<RadianceSums> sums(radiance.size());
  SampleSumsKernel kernel{view_of(radiance), mutable_view_of(blocks), mutable_view_of(sums), false, kWidth};
  Backend backend(1);
  uint32_t sample = 0;
  for (auto _ : state) {
    kernel.ends_block = ++sample % kBlockSamples == 0;
    launch(backend, "sample-sums", kernel, kWidth, kHeight);
  }
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_sample_sums);

}  // namespace
}  // namespace relume
