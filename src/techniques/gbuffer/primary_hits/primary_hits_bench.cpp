#include <benchmark/benchmark.h>

#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 256;
constexpr uint32_t kHeight = 256;

const CompiledScene& cornell() {
  static const CompiledScene scene(find_builtin_scene("cornell")->build(),
                                   CompileOptions{.camera = {}, .width = kWidth, .height = kHeight});
  return scene;
}

void bm_primary_hits(benchmark::State& state) {
  std::vector<Hit> hits(kWidth * kHeight);
  Backend backend(1);
  uint32_t sample = 0;
  for (auto _ : state) {
    const PrimaryHitsKernel kernel{
        cornell().view(), SampleIndex{.sample = sample++}, mutable_view_of(hits), {}, kWidth};
    launch(backend, "gbuffer", kernel, kWidth, kHeight);
  }
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_primary_hits);

/// Computes the surface points of a frame's hits.
void bm_make_surface_point(benchmark::State& state) {
  std::vector<Hit> hits(kWidth * kHeight);
  const PrimaryHitsKernel kernel{cornell().view(), SampleIndex{}, mutable_view_of(hits), {}, kWidth};
  Backend backend(1);
  launch(backend, "gbuffer", kernel, kWidth, kHeight);
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
    Sampler sampler = kernel.index.sampler(i % kWidth, i / kWidth);
    rays.push_back(lone_camera_ray(cornell().view().camera, i % kWidth, i / kWidth, sampler));
  }
  uint32_t i = 0;
  SurfacePoint sp;
  for (auto _ : state) {
    i = (i + 1) % (kWidth * kHeight);
    if (!hits[i].valid()) continue;
    make_surface_point(cornell().view(), rays[i], hits[i], 0.01f, sp);
    benchmark::DoNotOptimize(sp);
  }
}
BENCHMARK(bm_make_surface_point);

}  // namespace
}  // namespace relume
