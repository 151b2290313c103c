#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/light_sampling/static_light_lists/build_lists.h"

namespace relume {
namespace {

void bm_static_light_lists_build(benchmark::State& state) {
  const CompiledScene scene(find_builtin_scene("cover")->build(), {});
  Backend backend;
  size_t listed = 0;
  for (auto _ : state) {
    const LightListData data = build_light_lists(backend, scene.view(), {0, static_cast<uint32_t>(state.range(0))});
    listed = data.ids.size();
  }
  if (listed == 0) state.SkipWithError("no light is on any list");
}
BENCHMARK(bm_static_light_lists_build)->ArgName("rays")->Arg(1024)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace relume
