#include <benchmark/benchmark.h>

#include <vector>

#include "core/hash.h"
#include "techniques/light_sampling/adaptive_tiles/learned_tiles.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 640;
constexpr uint32_t kHeight = 360;

/// Feedback of a frame that looks at a plane, with `lights` lights of which each tile sees eight.
struct World {
  explicit World(uint32_t lights)
      : power(lights, AliasEntry{1, 0, 1.0f / static_cast<float>(lights)}), feedback(kWidth * kHeight) {
    camera.axes = make_frame(Vec3(0, 0, 1));
    camera.half_extent = {1, 0.5625f};
    camera.resolution = {kWidth, kHeight};
    for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
      const Vec2 raster(static_cast<float>(i % kWidth) + 0.5f, static_cast<float>(i / kWidth) + 0.5f);
      const Ray ray = generate(camera, raster, Vec2(0.5f));
      feedback[i].position = feedback[i].previous_position = 5.0f * ray.direction;
      const uint32_t near = hash(i % kWidth / 32, i / kWidth / 32);
      if (hash(i) % 3 > 0) feedback[i].offer((near + hash(i, 1u) % 8) % lights, false, 1, 0);
    }
    before.build_proxies({backend, "bench", scratch}, view_of(power), {}, 0, 0.75f);
    tiles.build_proxies({backend, "bench", scratch}, view_of(power), {}, 0, 0.75f);
    fill(1);
  }
  void fill(uint32_t seed) {
    tiles.fill(backend, {view_of(feedback), kWidth, kHeight, camera}, before, {}, seed);
    tiles.swap_lists(before);
  }

  Backend backend{1};
  PrimitiveScratch scratch;
  CameraView camera;
  std::vector<AliasEntry> power;
  std::vector<LightFeedback> feedback;
  LearnedTiles before{host_memory()};
  LearnedTiles tiles{host_memory()};
};

void bm_tiles_fill(benchmark::State& state) {
  World world(static_cast<uint32_t>(state.range(0)));
  uint32_t seed = 2;
  for (auto _ : state) world.fill(seed++);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(bm_tiles_fill)->ArgName("lights")->Arg(8)->Arg(1000)->Unit(benchmark::kMillisecond);

void bm_tiles_sample(benchmark::State& state) {
  const World world(static_cast<uint32_t>(state.range(0)));
  const AdaptiveTiles selector{world.before.lists(1.5f), world.before.proxies(), 0.65f};
  SurfacePoint sp{};
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    sp.previous_position = {4 * to_unit_float(hash(i, 1u)) - 2, 2 * to_unit_float(hash(i, 2u)) - 1, -4.5f};
    benchmark::DoNotOptimize(selector.sample(sp, to_unit_float(i), i));
  }
}
BENCHMARK(bm_tiles_sample)->ArgName("lights")->Arg(8)->Arg(1000)->Arg(100000);

}  // namespace
}  // namespace relume
