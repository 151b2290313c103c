#include "techniques/denoise/firefly_clamp/firefly_clamp.h"

#include <benchmark/benchmark.h>

#include <vector>

#include "scene/compiled_scene.h"
#include "scene/testing/media.h"

namespace relume {
namespace {

void bm_firefly_factor(benchmark::State& state) {
  constexpr uint32_t kSize = 64;
  const CompiledScene scene(testing::plate(testing::matte(Rgb(0.5f)), 5, 1e-3f),
                            {.camera = {}, .width = kSize, .height = kSize});
  Hit hit;
  hit.instance = 0;
  const std::vector<Hit> hits(kSize * kSize, hit);
  const std::vector<Rgb> radiance(kSize * kSize, Rgb(1));
  std::vector<float> factors(kSize * kSize);
  const FireflyFactorKernel kernel{scene.view(), view_of(hits), view_of(radiance), {}, mutable_view_of(factors), 8,
                                   kSize,        kSize};
  for (auto _ : state) {
    for (uint32_t i = 0; i < kSize * kSize; ++i) kernel(i % kSize, i / kSize);
    benchmark::DoNotOptimize(factors.data());
  }
  state.SetItemsProcessed(state.iterations() * kSize * kSize);
}
BENCHMARK(bm_firefly_factor);

}  // namespace
}  // namespace relume
