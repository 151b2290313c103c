#include <benchmark/benchmark.h>

#include <vector>

#include "lights/light_importance.h"
#include "lights/testing/lamps.h"

namespace relume {
namespace {

/// Computes the weights of a bucket of 32 lights, all at once or one by one.
void bm_light_importances(benchmark::State& state) {
  const std::vector<Light> lights = testing::make_lamps(1000, 10);
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = view.lights.size;
  const std::vector<CompactLight> list = compact_lights(view);
  const View<const CompactLight> compact = view_of(list);
  LightReceiver r;
  r.frame = make_frame(Vec3(0, 1, 0));
  r.position = {5, 0, 5};
  r.diffuse = 0.5f;
  r.glossy = state.range(0) ? 0.3f : 0.0f;
  r.glossy_matrix = ltc_table().at(0.7f, 0.5f);
  std::vector<LightId> ids(32);
  std::vector<float> weights(32);
  std::vector<float> expected(32);
  uint32_t i = 0;
  const auto next_bucket = [&] {
    for (LightId& id : ids) id = hash(i++) % 1000;
  };
  next_bucket();
  light_importances(r, view, compact, ids.data(), 32, weights.data());
  for (uint32_t k = 0; k < 32; ++k) {
    if (weights[k] != light_importance_of(r, view, compact, ids[k])) state.SkipWithError("the forms disagree");
  }
  for (auto _ : state) {
    next_bucket();
    if (state.range(1)) {
      benchmark::DoNotOptimize(light_importances(r, view, compact, ids.data(), 32, weights.data()));
    } else {
      for (uint32_t k = 0; k < 32; ++k) weights[k] = light_importance_of(r, view, compact, ids[k]);
      benchmark::DoNotOptimize(weights.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * 32);
}
BENCHMARK(bm_light_importances)->ArgNames({"glossy", "lanes"})->ArgsProduct({{0, 1}, {0, 1}});

}  // namespace
}  // namespace relume
