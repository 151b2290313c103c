#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "scene/testing/light_scene.h"

namespace relume {
namespace {

/// Look-ups at random positions: each misses the first-level cache, as on many small triangles.
void bm_texture(benchmark::State& state, float lod) {
  const std::vector<Texture> textures{testing::noise_texture(1024)};
  const TextureStore store(textures, TextureFilter::linear);
  const TexturesView view = store.view();
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    benchmark::DoNotOptimize(view.sample(0, {to_unit_float(i), to_unit_float(i << 8)}, lod));
  }
}
BENCHMARK_CAPTURE(bm_texture, finest_level, 0.0f);
BENCHMARK_CAPTURE(bm_texture, between_levels, 3.5f);

/// Adjacent look-ups, as from neighbouring pixels.
void bm_texture_coherent(benchmark::State& state) {
  const std::vector<Texture> textures{testing::noise_texture(1024)};
  const TextureStore store(textures, TextureFilter::linear);
  const TexturesView view = store.view();
  float u = 0;
  for (auto _ : state) {
    u += 0.7f / 1024;
    benchmark::DoNotOptimize(view.sample(0, {u, 0.3f}, 0.0f));
  }
}
BENCHMARK(bm_texture_coherent);

void bm_compile_scene(benchmark::State& state) {
  const Scene scene = find_builtin_scene("cornell")->build();
  for (auto _ : state) {
    const CompiledScene compiled(scene, CompileOptions{.camera = {}, .width = 16, .height = 16});
    SceneView view = compiled.view();
    benchmark::DoNotOptimize(view);
  }
}
BENCHMARK(bm_compile_scene)->Unit(benchmark::kMicrosecond);

/// A lamp moves in a static room of 20,000 triangles.
void bm_move_lamp(benchmark::State& state) {
  CompiledScene compiled(find_builtin_scene("slit")->build(), CompileOptions{.camera = {}, .width = 16, .height = 16});
  float time_s = 0;
  for (auto _ : state) {
    compiled.set_time(time_s);
    time_s = time_s < 7 ? time_s + 0.1f : 0;
  }
}
BENCHMARK(bm_move_lamp)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace relume
