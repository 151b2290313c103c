#include <benchmark/benchmark.h>

#include "scene/testing/light_scene.h"

namespace relume {
namespace {

const testing::LightScene& bench_scene() {
  static const testing::LightScene scene = testing::make_light_scene(testing::noise_environment(512, 256), 64);
  return scene;
}

Vec2 some_point(uint32_t& i) {
  i = i * 1664525u + 1013904223u;
  return {to_unit_float(i), to_unit_float(i << 8)};
}

void bm_sample_li(benchmark::State& state) {
  const auto id = static_cast<LightId>(state.range(0));
  const LightsView& view = bench_scene().lights();
  uint32_t i = 1;
  for (auto _ : state) benchmark::DoNotOptimize(sample_li(view, id, Vec3(0.1f, 0.2f, 0.3f), some_point(i)));
  state.SetLabel(bench_scene().named[id].name);
}
BENCHMARK(bm_sample_li)->DenseRange(0, 8);

void bm_sample_le(benchmark::State& state) {
  const auto id = static_cast<LightId>(state.range(0));
  const LightsView& view = bench_scene().lights();
  uint32_t i = 1;
  for (auto _ : state) {
    const Vec2 u = some_point(i);
    benchmark::DoNotOptimize(sample_le(view, id, u, some_point(i)));
  }
  state.SetLabel(bench_scene().named[id].name);
}
BENCHMARK(bm_sample_le)->DenseRange(0, 8);

void bm_environment_radiance(benchmark::State& state) {
  const EnvironmentView& environment = bench_scene().lights().environment;
  uint32_t i = 1;
  for (auto _ : state) benchmark::DoNotOptimize(environment.radiance(sphere_from_square(some_point(i))));
}
BENCHMARK(bm_environment_radiance);

}  // namespace
}  // namespace relume
