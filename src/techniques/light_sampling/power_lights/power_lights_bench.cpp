#include <benchmark/benchmark.h>

#include "techniques/light_sampling/power_lights/power_lights.h"

namespace relume {
namespace {

/// Point lights of random intensity.
std::vector<Light> many_lights(uint32_t count) {
  std::vector<Light> lights(count);
  for (uint32_t i = 0; i < count; ++i) {
    lights[i].kind = LightKind::point;
    lights[i].point = {Vec3(0), Rgb(to_unit_float(hash(i)))};
  }
  return lights;
}

LightsView view_of_lights(const std::vector<Light>& lights) {
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = view.lights.size;
  return view;
}

void bm_power_lights(benchmark::State& state) {
  const auto lights = many_lights(static_cast<uint32_t>(state.range(0)));
  const auto entries = build_power_lights(view_of_lights(lights));
  const PowerLights selector{{view_of(entries)}};
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    benchmark::DoNotOptimize(selector.sample({to_unit_float(i), i}));
  }
}
BENCHMARK(bm_power_lights)->Arg(10)->Arg(100'000);

void bm_build_power_lights(benchmark::State& state) {
  const auto lights = many_lights(static_cast<uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(build_power_lights(view_of_lights(lights)));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(bm_build_power_lights)->Arg(10'000);

}  // namespace
}  // namespace relume
