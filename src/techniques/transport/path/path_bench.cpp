#include <benchmark/benchmark.h>

#include <cstddef>
#include <utility>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume {
namespace {

/// Bars of one texel around holes of seven, three quarters open.
Texture lattice() {
  Texture texture;
  texture.name = "lattice";
  texture.width = texture.height = 64;
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) {
      const int alpha = x % 8 == 0 || y % 8 == 0 ? 255 : 0;
      for (const int channel : {120, 160, 90, alpha}) texture.texels.push_back(static_cast<std::byte>(channel));
    }
  }
  return texture;
}

/// The Cornell box behind eight lattices in a row.
Scene masked_cornell() {
  Scene scene = find_builtin_scene("cornell")->build();
  scene.textures.push_back(lattice());
  Material material;
  material.name = "lattice";
  material.base_color_texture.texture = static_cast<Index>(scene.textures.size()) - 1;
  material.alpha_mode = AlphaMode::mask;
  material.double_sided = true;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.name = "lattices";
  mesh.material = static_cast<Index>(scene.materials.size()) - 1;
  for (uint32_t i = 0; i < 8; ++i) {
    const float z = 2.6f - 0.1f * static_cast<float>(i);
    for (const Vec2 uv : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
      mesh.positions.emplace_back(5 * uv.x - 2.5f, 5 * uv.y + 0.1f, z);
      mesh.uv0.push_back(uv);
    }
    mesh.triangles.insert(mesh.triangles.end(), {{4 * i, 4 * i + 1, 4 * i + 2}, {4 * i, 4 * i + 2, 4 * i + 3}});
  }
  scene.meshes.push_back(std::move(mesh));
  Node node;
  node.meshes = {static_cast<Index>(scene.meshes.size()) - 1};
  scene.add_node(std::move(node));
  return scene;
}

/// Renders frames of one sample per pixel on one thread.
void bm_frame(benchmark::State& state, Scene scene) {
  RenderSettings settings;
  settings.width = settings.height = 128;
  settings.threads = 1;
  Session session(std::move(scene), settings);
  for (auto _ : state) session.render_frame();
  const Statistics& s = session.statistics();
  if (s.nonfinite_samples > 0) state.SkipWithError("samples that are not finite");
  state.SetItemsProcessed(static_cast<int64_t>(s.samples));
  state.counters["rays/sample"] = static_cast<double>(s.rays) / static_cast<double>(s.samples);
}

void bm_path(benchmark::State& state, const char* name) { bm_frame(state, find_builtin_scene(name)->build()); }
void bm_path_masked(benchmark::State& state) { bm_frame(state, masked_cornell()); }

BENCHMARK_CAPTURE(bm_path, cornell, "cornell")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, furnace, "furnace")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, textured, "door")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, sun_sky, "mine")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, instances, "city")->Unit(benchmark::kMillisecond);
BENCHMARK(bm_path_masked)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
