#include <benchmark/benchmark.h>

#include <vector>

#include "techniques/light_sampling/light_tree/build_light_tree.h"

namespace relume {
namespace {

std::vector<Light> lamps(uint32_t count) {
  std::vector<Light> lights(count);
  for (uint32_t i = 0; i < count; ++i) {
    const auto random = [i](uint32_t k) { return to_unit_float(hash(i, k)); };
    TriangleLight t{};
    t.v0 = {30 * random(0), 3, 30 * random(1)};
    t.e1 = {0.3f, 0, 0};
    t.e2 = {0, 0, 0.3f};
    t.normal = {0, -1, 0};
    t.area = 0.045f;
    t.radiance = Rgb(1 + random(2));
    t.textured = -1;
    lights[i].kind = LightKind::triangle;
    lights[i].triangle = t;
  }
  return lights;
}

LightsView view_of_lights(const std::vector<Light>& lights) {
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = view.lights.size;
  return view;
}

void bm_light_tree_sample(benchmark::State& state) {
  const std::vector<Light> lights = lamps(static_cast<uint32_t>(state.range(0)));
  const LightTreeData data = build_light_tree(view_of_lights(lights));
  const LightTree tree = data.view(view_of_lights(lights));
  SurfacePoint sp{};
  sp.frame = make_frame(Vec3(0, 1, 0));
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    sp.position = {30 * to_unit_float(hash(i, 1u)), 0, 30 * to_unit_float(hash(i, 2u))};
    benchmark::DoNotOptimize(tree.sample(sp, {to_unit_float(i), i}));
  }
}
BENCHMARK(bm_light_tree_sample)->Arg(10)->Arg(1000)->Arg(100'000);

void bm_light_tree_build(benchmark::State& state) {
  const std::vector<Light> lights = lamps(static_cast<uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(build_light_tree(view_of_lights(lights)));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(bm_light_tree_build)->Arg(1000)->Arg(10'000);

}  // namespace
}  // namespace relume
